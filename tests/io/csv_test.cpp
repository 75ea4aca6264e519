#include "io/csv.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <cmath>
#include <functional>

#include "base/error.h"
#include "io/atomic_file.h"

namespace dexremoe {
namespace {

using ::testing::ElementsAre;
using ::testing::HasSubstr;

CsvTable ReadText(const std::string& text) {
  const std::string path = ::testing::TempDir() + "table.csv";
  WriteFile(path, text);
  return CsvTable::Read(path);
}

std::string Message(const std::function<void()>& body) {
  try {
    body();
  } catch (const Error& error) {
    return error.what();
  }
  return "no error";
}

TEST(Csv, WhatIsWrittenComesBack) {
  CsvWriter writer({"name", "value, m", "note"});
  writer.Row({"a", "1.5", "plain"});
  writer.Row({"b,c", "-2e-3", "say \"x\""});
  writer.Row({"", "nan", "#not a comment"});
  const CsvTable table = ReadText(writer.text());
  EXPECT_THAT(table.columns(), ElementsAre("name", "value, m", "note"));
  EXPECT_THAT(table.Text("name"), ElementsAre("a", "b,c", ""));
  EXPECT_THAT(table.Text("note"), ElementsAre("plain", "say \"x\"", "#not a comment"));
  const auto values = table.Numbers("value, m");
  EXPECT_EQ(values[1], -2e-3);
  EXPECT_TRUE(std::isnan(values[2]));
}

TEST(Csv, CommentsEmptyLinesCarriageReturnsAndAMissingLastNewlineAreFine) {
  const CsvTable table = ReadText("# a comment\r\nx,y\r\n\r\n1,2\r\n# more\n3,4");
  EXPECT_EQ(table.num_rows(), 2u);
  EXPECT_THAT(table.Numbers("y"), ElementsAre(2, 4));
}

TEST(Csv, MessagesNameLineAndColumn) {
  EXPECT_THAT(Message([] { ReadText("x,y\n1,2\n3\n"); }),
              HasSubstr("line 3: expected 2 fields, found 1"));
  EXPECT_THAT(Message([] { ReadText("x,y\n1,\"2\n"); }), HasSubstr("line 2: a quote"));
  EXPECT_THAT(Message([] { ReadText("# nothing\n"); }), HasSubstr("header line"));
  EXPECT_THAT(Message([] { ReadText("x,y\n1,2\n").Numbers("z"); }), HasSubstr("found x, y"));
  EXPECT_THAT(Message([] { ReadText("x\n1\n2m\n").Numbers("x"); }),
              HasSubstr("line 3: column 'x': expected a number, found '2m'"));
  EXPECT_THAT(Message([] { ReadText("x,y\n1,\n").Numbers("y"); }), HasSubstr("line 2"));
  EXPECT_THAT(Message([] { CsvTable::Read("/nowhere/t.csv"); }), HasSubstr("/nowhere/t.csv"));
}

}  // namespace
}  // namespace dexremoe
