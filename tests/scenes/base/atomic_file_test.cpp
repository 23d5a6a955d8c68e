#include "scenes/base/atomic_file.h"

#include <gtest/gtest.h>
#include <sys/wait.h>
#include <unistd.h>

#include <csignal>
#include <fstream>
#include <iterator>
#include <string>

#include "scenes/base/error.h"

namespace raymeter {
namespace {

class AtomicFiles : public testing::Test {
 protected:
  AtomicFiles() {
    std::string name = testing::TempDir() + "atomic.XXXXXX";
    folder_ = mkdtemp(name.data());
  }
  ~AtomicFiles() override { std::filesystem::remove_all(folder_); }

  static void write(const std::filesystem::path& file, const std::string& text) {
    std::ofstream(file) << text;
  }
  std::string text() const {
    std::ifstream stream(folder_ / "a.png");
    return {std::istreambuf_iterator<char>(stream), {}};
  }
  std::ptrdiff_t files() const {
    return std::distance(std::filesystem::directory_iterator(folder_), std::filesystem::directory_iterator());
  }

  std::filesystem::path folder_;
};

TEST_F(AtomicFiles, AppearsWhenCommitted) {
  write(folder_ / "a.png", "old");
  {
    AtomicFile file(folder_ / "a.png");
    EXPECT_EQ(file.temporary().extension(), ".png");
    write(file.temporary(), "new");
    EXPECT_EQ(text(), "old");
    file.commit();
    EXPECT_EQ(text(), "new");
  }
  EXPECT_EQ(files(), 1);
}

TEST_F(AtomicFiles, LeavesNothingWhenAbandoned) {
  {
    AtomicFile file(folder_ / "a.png");
    write(file.temporary(), "half");
  }
  EXPECT_EQ(files(), 0);
  AtomicFile nowhere(folder_ / "none" / "a.png");
  EXPECT_THROW(nowhere.commit(), Error);
}

TEST_F(AtomicFiles, LeavesNothingWhenInterrupted) {
  for (const int signal : {SIGINT, SIGTERM, SIGHUP}) {
    const pid_t child = fork();
    if (child == 0) {
      AtomicFile file(folder_ / "a.png");
      write(file.temporary(), "half");
      raise(signal);
      _exit(0);
    }
    int status = 0;
    waitpid(child, &status, 0);
    EXPECT_TRUE(WIFSIGNALED(status) && WTERMSIG(status) == signal);
    EXPECT_EQ(files(), 0);
  }
}

}  // namespace
}  // namespace raymeter
