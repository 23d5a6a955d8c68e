#include "reports/record_files.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <sstream>

#include "scenes/base/error.h"

namespace raymeter {
namespace {

class RecordFiles : public testing::Test {
 protected:
  void SetUp() override {
    folder_ = std::filesystem::path(testing::TempDir()) /
              testing::UnitTest::GetInstance()->current_test_info()->name();
    std::filesystem::remove_all(folder_);
    std::filesystem::create_directories(folder_);
  }
  void TearDown() override { std::filesystem::remove_all(folder_); }
  std::filesystem::path file(const char* name) const { return folder_ / name; }
  static std::string content(const std::filesystem::path& path) {
    std::ostringstream text;
    text << std::ifstream(path, std::ios::binary).rdbuf();
    return text.str();
  }

  std::filesystem::path folder_;
};

Record example() {
  Record record;
  record.key = "k1";
  record.scene = "a \"quoted\", scene";
  record.rays = 76800;
  record.ratio = 0.1;  // no short binary form: must come back to the last bit
  record.bytes = 0;    // present, and zero: not the same as absent
  return record;
}

TEST_F(RecordFiles, LogReturnsWhatWasAppended) {
  {
    RecordLog log(file("records.jsonl"));
    EXPECT_TRUE(log.records().empty());
    log.append(example());
  }
  const RecordLog log(file("records.jsonl"));
  ASSERT_EQ(log.records().size(), 1u);
  const Record& back = log.records()[0];
  for (const Column& column : columns()) EXPECT_EQ(column.text(back), column.text(example())) << column.name;
  EXPECT_FALSE(back.wrong.has_value());
  EXPECT_EQ(back.bytes, 0u);
}

TEST_F(RecordFiles, AKilledRunsHalfLineIsCutOff) {
  RecordLog(file("records.jsonl")).append(example());
  const std::string whole = content(file("records.jsonl"));
  for (const std::size_t cut : {std::size_t{1}, whole.size() / 2, whole.size() - 1}) {
    std::ofstream(file("records.jsonl"), std::ios::binary) << whole << whole.substr(0, cut);
    RecordLog log(file("records.jsonl"));
    EXPECT_EQ(log.records().size(), 1u);
    log.append(example());
    EXPECT_EQ(content(file("records.jsonl")), whole + whole);
  }
}

TEST_F(RecordFiles, ForeignContentIsRefusedWithItsLine) {
  RecordLog(file("records.jsonl")).append(example());
  std::ofstream(file("records.jsonl"), std::ios::app) << "not json\n";
  try {
    RecordLog log(file("records.jsonl"));
    FAIL() << "accepted";
  } catch (const Error& error) {
    EXPECT_THAT(error.what(), testing::HasSubstr("records.jsonl:2: not a record"));
  }
}

TEST_F(RecordFiles, NumbersThatCannotBeAreRefused) {
  const std::pair<const char*, const char*> cases[] = {
      {R"({"rays": -1})", "column rays: not a count"},
      {R"({"rays": 1.5})", "column rays: not a count"},
      {R"({"rays": 1e300})", "column rays: not a count"},
      {R"({"rays": "3"})", "column rays: not a count"},
      {R"({"ratio": null})", "column ratio: not a number"},
      {R"({"ratio": 1e999})", "not a record ("},
      {R"({"scene": 3})", "not a record ("},
      {"[]", "not a record ("},
  };
  for (const auto& [line, why] : cases) {
    std::ofstream(file("records.jsonl")) << line << '\n';
    try {
      read_records(file("records.jsonl"));
      ADD_FAILURE() << "accepted " << line;
    } catch (const Error& error) {
      EXPECT_THAT(error.what(), testing::HasSubstr("records.jsonl:1: not a record ("));
      EXPECT_THAT(error.what(), testing::HasSubstr(why));
    }
  }
  std::ofstream(file("records.jsonl")) << R"({"rays": 3, "ratio": 2})" << '\n';
  EXPECT_EQ(read_records(file("records.jsonl"))[0].rays, 3u);
}

TEST_F(RecordFiles, EnvironmentsOfOtherMachinesAreKept) {
  using Entries = std::vector<std::pair<std::string, std::string>>;
  write_environment(file("environment.json"), "aa", Entries{{"time", "1"}, {"cpu", "old"}});
  write_environment(file("environment.json"), "bb", Entries{{"time", "2"}, {"cpu", "new \"quoted\""}});
  write_environment(file("environment.json"), "aa", Entries{{"time", "3"}});
  EXPECT_EQ(content(file("environment.json")), R"({
  "aa": {
    "time": "3"
  },
  "bb": {
    "time": "2",
    "cpu": "new \"quoted\""
  }
}
)");
}

TEST_F(RecordFiles, AForeignEnvironmentIsRefusedAndLeftAlone) {
  for (const char* foreign : {"", "{", "[]", "3", "{\"cpu\": \"a flat object\"}", "{} {}"}) {
    std::ofstream(file("environment.json"), std::ios::binary) << foreign;
    try {
      write_environment(file("environment.json"), "aa", {});
      FAIL() << "accepted " << foreign;
    } catch (const Error& error) {
      EXPECT_THAT(error.what(), testing::HasSubstr("environment.json: not a JSON object of environments"));
    }
    EXPECT_EQ(content(file("environment.json")), foreign);
  }
  std::filesystem::remove(file("environment.json"));
  std::filesystem::create_directory(file("environment.json"));
  EXPECT_THROW(write_environment(file("environment.json"), "aa", {}), Error);
}

TEST_F(RecordFiles, CsvHasAHeaderQuotesAndEmptyFields) {
  write_csv(file("records.csv"), std::vector<Record>{example()});
  const std::string text = content(file("records.csv"));
  EXPECT_THAT(
      text, testing::StartsWith("scene,scene_hash,structure,spec,batch,rays,hits,ray_hash,reference_hash,"));
  EXPECT_THAT(text, testing::HasSubstr("\n\"a \"\"quoted\"\", scene\",,,,,76800,,"));
  EXPECT_EQ(std::count(text.begin(), text.end(), '\n'), 2);
}

TEST_F(RecordFiles, ColumnNamesAreUniqueAndTheAgreedOnesComeFirst) {
  std::string names;
  for (const Column& column : columns()) {
    EXPECT_EQ(names.find("," + std::string(column.name) + ","), std::string::npos) << column.name;
    names += "," + std::string(column.name) + ",";
    EXPECT_FALSE(column.meaning.empty());
  }
}

TEST_F(RecordFiles, AFolderThatCannotBeWrittenIsAnError) {
  EXPECT_THROW(write_csv(file("missing/records.csv"), {}), Error);
  EXPECT_THROW(RecordLog(file("missing/records.jsonl")), Error);
}

}  // namespace
}  // namespace raymeter
