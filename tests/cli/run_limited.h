#pragma once
// Runs the `raymeter` command under limits, as its user would.
#include <fcntl.h>
#include <sys/resource.h>
#include <sys/wait.h>
#include <unistd.h>

#include <array>
#include <cstdint>
#include <string>
#include <vector>

namespace raymeter {

struct Limits {
  unsigned cpu_seconds = 20;
  unsigned wall_seconds = 200;  ///< of a machine that does other things too: catches what waits for ever
};

struct LimitedRun {
  int status = -1;  ///< exit status; -1 when a signal ended it
  int signal = 0;
  std::string text;  ///< standard output and standard error
  double cpu_seconds = 0;
  std::uint64_t peak_bytes = 0;  ///< resident
};

/// The command with these arguments (no shell in between). What exceeds a limit is killed: `signal` says so.
inline LimitedRun run_limited(const std::vector<std::string>& arguments, const Limits& limits = {}) {
  std::vector<std::string> words{RAYMETER_COMMAND};
  words.insert(words.end(), arguments.begin(), arguments.end());
  std::vector<char*> argv;
  for (std::string& word : words) argv.push_back(word.data());
  argv.push_back(nullptr);

  std::array<int, 2> ends{};
  LimitedRun run;
  if (pipe(ends.data()) != 0) return run;
  const pid_t child = fork();
  if (child == 0) {
    const rlimit cpu{limits.cpu_seconds, limits.cpu_seconds}, core{0, 0};
    setrlimit(RLIMIT_CPU, &cpu);
    setrlimit(RLIMIT_CORE, &core);
    alarm(limits.wall_seconds);  // survives exec; its signal ends the command
    const int nothing = open("/dev/null", O_RDONLY);
    dup2(nothing, STDIN_FILENO);
    dup2(ends[1], STDOUT_FILENO);
    dup2(ends[1], STDERR_FILENO);
    close(ends[0]);
    close(ends[1]);
    execv(argv[0], argv.data());
    _exit(127);
  }
  close(ends[1]);
  std::array<char, 4096> buffer;
  for (ssize_t n = 0; (n = read(ends[0], buffer.data(), buffer.size())) > 0;)
    run.text.append(buffer.data(), static_cast<std::size_t>(n));
  close(ends[0]);
  int status = 0;
  rusage used{};
  if (child < 0 || wait4(child, &status, 0, &used) != child) return run;
  if (WIFEXITED(status)) run.status = WEXITSTATUS(status);
  if (WIFSIGNALED(status)) run.signal = WTERMSIG(status);
  const auto seconds = [](const timeval& t) {
    return static_cast<double>(t.tv_sec) + 1e-6 * static_cast<double>(t.tv_usec);
  };
  run.cpu_seconds = seconds(used.ru_utime) + seconds(used.ru_stime);
  run.peak_bytes = static_cast<std::uint64_t>(used.ru_maxrss) * 1024;
  return run;
}

}  // namespace raymeter
