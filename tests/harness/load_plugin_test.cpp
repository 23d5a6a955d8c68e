#include "harness/load_plugin.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <cstdlib>
#include <filesystem>
#include <fstream>
#include <iterator>
#include <string>

#include "accel/plugin.h"
#include "scenes/base/error.h"
#include "scenes/open_scene.h"

namespace raymeter {
namespace {

using testing::HasSubstr;
namespace fs = std::filesystem;

fs::path plugin(const std::string& name) {
  return fs::path(RAYMETER_TEST_PLUGINS) / (name + ".so");
}

/// The message of the Error with which a plug-in is refused; nothing may have been registered.
std::string refusal(const fs::path& file) {
  Registry registry;
  register_accel(registry);
  const std::size_t before = registry.kinds().size();
  try {
    load_plugin(file, registry);
  } catch (const Error& error) {
    EXPECT_EQ(registry.kinds().size(), before);
    EXPECT_EQ(std::string(error.what()).find('\n'), std::string::npos) << error.what();
    EXPECT_THAT(error.what(), testing::StartsWith(file.string() + ": "));
    return error.what();
  }
  ADD_FAILURE() << file << " was loaded";
  return {};
}

fs::path file_with(const std::string& name, const std::string& content) {
  fs::path file = fs::path(testing::TempDir()) / ("plugin_" + name);
  std::ofstream(file, std::ios::binary) << content;
  return file;
}

TEST(LoadPlugin, ItsStructureIsBuiltAndTraces) {
  Registry registry;
  load_plugin(plugin("good"), registry);
  ASSERT_EQ(registry.kinds().size(), 1u);
  const Scene scene = open_scene("soup:triangles=10");
  const auto structure = registry.build(parse_spec("good"), {scene});
  const Triangle triangle = scene.triangle(0);
  const Vec3 middle = 0.25f * triangle.a + 0.25f * triangle.b + 0.5f * triangle.c;
  const std::vector<Ray> rays{{.origin = middle - Vec3{0, 0, 9}, .direction = {0, 0, 1}}};
  std::vector<Hit> hits(1);
  structure->trace_closest({.rays = rays}, hits);
  EXPECT_TRUE(hits[0].found());
}

TEST(LoadPlugin, ANameWithoutASlashIsAFileHere) {
  const fs::path before = fs::current_path();
  fs::current_path(RAYMETER_TEST_PLUGINS);
  Registry registry;
  load_plugin("good.so", registry);
  fs::current_path(before);
  EXPECT_EQ(registry.kinds().size(), 1u);
}

TEST(LoadPlugin, RefusesWhatIsNoSharedLibrary) {
  EXPECT_THAT(refusal("/nosuch/libmine.so"), HasSubstr("no such plug-in"));
  EXPECT_THAT(refusal(testing::TempDir()), HasSubstr("not a shared library"));
  EXPECT_THAT(refusal("/dev/zero"), HasSubstr("not a shared library"));
  EXPECT_THAT(refusal(file_with("empty", "")), HasSubstr("not a shared library"));
  EXPECT_THAT(refusal(file_with("text", "#!/bin/sh\nexit 1\n")), HasSubstr("not a shared library"));
}

TEST(LoadPlugin, RefusesATruncatedLibraryWhereverItEnds) {
  std::ifstream in(plugin("good"), std::ios::binary);
  const std::string whole{std::istreambuf_iterator<char>(in), {}};
  ASSERT_GT(whole.size(), 8192u);
  // Mapped by the loader, these would end the program with a bus error. What is at the end, names for
  // debuggers, is not mapped.
  for (const std::size_t size : {20u, 100u, 4096u, 8192u})
    EXPECT_THAT(refusal(file_with("truncated", whole.substr(0, size))), HasSubstr("not a shared library"));
}

TEST(LoadPlugin, RefusesWhatIsNoPluginOrOneForAnotherRaymeter) {
  EXPECT_THAT(refusal(plugin("no_entry")), HasSubstr("RAYMETER_PLUGIN is missing"));
  // Its function would end this program.
  EXPECT_THAT(refusal(plugin("other_abi")),
              HasSubstr("built for Raymeter 0.0.1, interface 0; this is Raymeter " RAYMETER_VERSION));
}

TEST(LoadPlugin, RefusesARegistrationThatFailsAndKeepsNothingOfIt) {
  EXPECT_THAT(refusal(plugin("throws")), HasSubstr("no licence found"));
  setenv("RAYMETER_TEST_THROWS", "42", 1);
  EXPECT_THAT(refusal(plugin("throws")), HasSubstr("can't be registered"));
  unsetenv("RAYMETER_TEST_THROWS");
  EXPECT_THAT(refusal(plugin("taken")), HasSubstr("'grid' is registered twice"));
  EXPECT_THAT(refusal(plugin("nothing")), HasSubstr("registers no structure"));
}

TEST(LoadPlugin, RefusesTheSamePluginTwice) {
  Registry registry;
  load_plugin(plugin("good"), registry);
  EXPECT_THROW(load_plugin(plugin("good"), registry), Error);
  EXPECT_EQ(registry.kinds().size(), 1u);
}

}  // namespace
}  // namespace raymeter
