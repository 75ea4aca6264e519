#include "io/h5.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>
#include <unistd.h>

#include <cmath>
#include <filesystem>
#include <fstream>
#include <limits>
#include <thread>

#include "base/error.h"
#include "io/atomic_file.h"
#include "io/h5_inspect.h"

namespace dexremoe {
namespace {

using ::testing::AllOf;
using ::testing::ElementsAre;
using ::testing::HasSubstr;
using ::testing::IsEmpty;
using ::testing::SizeIs;

constexpr H5Format kFormat{"dexremoe.test", 3};
constexpr H5Doc kDoc{"m", "row, axis", "numbers of a test"};

std::string Path(const std::string& name) {
  return (std::filesystem::path(::testing::TempDir()) /
          ("h5_test_" + std::to_string(getpid()) + "_" + name))
      .string();
}

// One dataset of every type.
void WriteSample(const std::string& path, double first = 1.5, std::uint64_t seed = 7,
                 const std::string& options = "a = 1\n") {
  H5Writer file(path, kFormat, {"test_tool", options, seed, {}});
  file.Write("real", std::vector<double>{first, -0.0, NAN, INFINITY, 5e-324, 6}, {2, 3}, kDoc);
  file.Write("deep/down/single", std::vector<float>{0.1f, 2}, {2}, kDoc);
  file.Write("i32", std::vector<std::int32_t>{-2147483647 - 1, 2147483647}, {2}, kDoc);
  file.Write("i64", std::vector<std::int64_t>{std::numeric_limits<std::int64_t>::min()}, {1}, kDoc);
  file.Write("u64", std::vector<std::uint64_t>{~0ull}, {1}, kDoc);
  file.Write("u8", std::vector<std::uint8_t>{0, 255}, {2}, kDoc);
  file.Write("empty", std::vector<double>{}, {0, 3}, kDoc);
  file.WriteScalar("scalar", 2.5, {"kg", "", "one number"});
  file.WriteStrings("names", {"alpha", "", "γ delta"}, {"", "row", "texts"});
  file.WriteString("name", "one", {"", "", "a text"});
  file.Commit();
}

// The message of the Error that `body` throws.
template <typename Body>
std::string Message(Body body) {
  try {
    body();
  } catch (const Error& error) {
    return error.what();
  }
  return "no error";
}

TEST(H5, EveryTypeComesBackBitForBit) {
  const std::string path = Path("types.h5");
  WriteSample(path);
  const H5Reader file(path, kFormat);
  const auto real = file.Read<double>("real", {-1, 3});
  EXPECT_THAT(real.dims, ElementsAre(2, 3));
  EXPECT_EQ(real.values[0], 1.5);
  EXPECT_TRUE(std::signbit(real.values[1]));
  EXPECT_TRUE(std::isnan(real.values[2]));
  EXPECT_TRUE(std::isinf(real.values[3]));
  EXPECT_EQ(real.values[4], 5e-324);
  EXPECT_THAT(file.ReadValues<float>("deep/down/single", {2}), ElementsAre(0.1f, 2));
  EXPECT_THAT(file.ReadValues<std::int32_t>("i32", {-1}), ElementsAre(-2147483647 - 1, 2147483647));
  EXPECT_THAT(file.ReadValues<std::int64_t>("i64", {1}),
              ElementsAre(std::numeric_limits<std::int64_t>::min()));
  EXPECT_THAT(file.ReadValues<std::uint64_t>("u64", {1}), ElementsAre(~0ull));
  EXPECT_THAT(file.ReadValues<std::uint8_t>("u8", {2}), ElementsAre(0, 255));
  EXPECT_THAT(file.ReadValues<double>("empty", {-1, 3}), IsEmpty());
  EXPECT_EQ(file.ReadScalar<double>("scalar"), 2.5);
  EXPECT_THAT(file.ReadStrings("names"), ElementsAre("alpha", "", "γ delta"));
  EXPECT_EQ(file.ReadString("name"), "one");
}

TEST(H5, ProvenanceAndDocsAreKept) {
  const std::string input = Path("input.txt"), path = Path("provenance.h5");
  WriteFile(input, "some input");
  {
    H5Writer file(path, kFormat, {"test_tool", "a = 1\nb = \"x\"\n", 99, {input}});
    file.WriteScalar("x", 1.0, kDoc);
    file.Commit();
  }
  const H5Reader file(path);
  EXPECT_EQ(file.Attribute("format"), "dexremoe.test");
  EXPECT_EQ(file.Attribute("format_version"), "3");
  EXPECT_EQ(file.Attribute("tool"), "test_tool");
  EXPECT_EQ(file.Attribute("options"), "a = 1\nb = \"x\"\n");
  EXPECT_EQ(file.Attribute("seed"), "99");
  EXPECT_THAT(file.Attribute("inputs"), ::testing::MatchesRegex(".*input.txt [0-9a-f]{32}\n"));
  EXPECT_EQ(file.DatasetAttribute("x", "unit"), "m");
  EXPECT_EQ(file.DatasetAttribute("x", "dims"), "row, axis");
  EXPECT_EQ(file.DatasetAttribute("x", "doc"), "numbers of a test");
}

TEST(H5, TwoEqualWritesGiveEqualBytes) {
  WriteSample(Path("a.h5"));
  std::this_thread::sleep_for(std::chrono::milliseconds(1100));  // another second on the clock
  WriteSample(Path("b.h5"));
  EXPECT_EQ(ReadFile(Path("a.h5")), ReadFile(Path("b.h5")));
}

TEST(H5, AnInputThatIsMissingIsNamedAndLeavesNothing) {
  const std::string path = Path("orphan.h5");
  EXPECT_THAT(Message([&] {
                H5Writer(path, kFormat, {"t", "", 1, {"/nowhere/mesh.h5"}});
              }),
              HasSubstr("/nowhere/mesh.h5"));
  EXPECT_FALSE(std::filesystem::exists(path + ".tmp"));
}

TEST(H5, WithoutCommitNothingIsLeft) {
  const std::string path = Path("uncommitted.h5");
  {
    H5Writer file(path, kFormat, {"t", "", 1, {}});
    file.WriteScalar("x", 1.0, kDoc);
  }
  EXPECT_FALSE(std::filesystem::exists(path));
  EXPECT_FALSE(std::filesystem::exists(path + ".tmp"));
}

TEST(H5, MessagesNameFileFieldExpectedAndFound) {
  const std::string path = Path("messages.h5");
  WriteSample(path);
  EXPECT_THAT(Message([&] {
                H5Reader(path, {"dexremoe.mesh", 3});
              }),
              AllOf(HasSubstr(path), HasSubstr("dexremoe.mesh"), HasSubstr("dexremoe.test")));
  EXPECT_THAT(Message([&] {
                H5Reader(path, {"dexremoe.test", 4});
              }),
              AllOf(HasSubstr(path), HasSubstr("version 4"), HasSubstr("version 3")));
  const H5Reader file(path, kFormat);
  EXPECT_THAT(Message([&] { file.Read<double>("absent", {1}); }),
              AllOf(HasSubstr(path), HasSubstr("'absent' is missing")));
  EXPECT_THAT(Message([&] { file.Read<double>("deep/absent/x", {1}); }), HasSubstr("is missing"));
  EXPECT_THAT(Message([&] { file.Read<double>("deep", {1}); }), HasSubstr("found a group"));
  EXPECT_THAT(Message([&] {
                file.Read<float>("real", {2, 3});
              }),
              AllOf(HasSubstr("'real'"), HasSubstr("expected float32, found float64")));
  EXPECT_THAT(Message([&] { file.Read<double>("names", {3}); }),
              HasSubstr("expected float64, found string"));
  EXPECT_THAT(Message([&] {
                file.Read<double>("real", {-1, 4});
              }),
              HasSubstr("expected extents [any, 4], found [2, 3]"));
  EXPECT_THAT(Message([&] { file.Read<double>("real", {6}); }), HasSubstr("found [2, 3]"));
  EXPECT_THAT(Message([&] { file.ReadScalar<double>("real"); }), HasSubstr("expected extents []"));
  EXPECT_THAT(Message([&] { file.ReadStrings("real"); }), HasSubstr("'real': expected text"));
  EXPECT_THAT(Message([&] { file.ReadStrings("deep"); }), HasSubstr("'deep'"));
  EXPECT_THAT(Message([&] { file.ReadString("names"); }), HasSubstr("expected one text, found 3"));
}

TEST(H5, ForeignAndDamagedFilesAreRefused) {
  EXPECT_THAT(Message([] { H5Reader("/nowhere/x.h5"); }), HasSubstr("/nowhere/x.h5: no such file"));
  EXPECT_THAT(Message([] { H5Reader("tests"); }), HasSubstr("tests"));
  const std::string path = Path("damaged.h5");
  WriteFile(path, "not an HDF5 file");
  EXPECT_THAT(Message([&] { H5Reader reader(path); }), HasSubstr("expected an HDF5 file"));
  WriteFile(path, "");
  EXPECT_THAT(Message([&] { H5Reader reader(path); }), HasSubstr("expected an HDF5 file"));
  WriteSample(path);
  const std::string whole = ReadFile(path);
  for (const double part : {0.1, 0.5, 0.9, 0.999}) {
    WriteFile(path, whole.substr(0, static_cast<std::size_t>(part * whole.size())));
    EXPECT_NE(Message([&] {
                H5Reader(path, kFormat).Read<double>("real", {2, 3});
              }),
              "no error")
        << part;
  }
}

TEST(H5, LongOptionTextsAreKeptOrRefused) {
  const std::string path = Path("long.h5");
  const std::string text(60000, 'x');
  {
    H5Writer file(path, kFormat, {"t", text, 1, {}});
    file.Commit();
  }
  EXPECT_EQ(H5Reader(path).Attribute("options"), text);
  EXPECT_THAT(Message([&] {
                H5Writer(path, kFormat, {"t", std::string(70000, 'x'), 1, {}});
              }),
              AllOf(HasSubstr(path), HasSubstr("options")));
  EXPECT_EQ(H5Reader(path).Attribute("options"), text);
  EXPECT_FALSE(std::filesystem::exists(path + ".tmp"));
}

TEST(H5, TheListOfDatasetsIsSorted) {
  const std::string path = Path("list.h5");
  WriteSample(path);
  const H5Reader file(path);
  EXPECT_THAT(file.Datasets(), ElementsAre("deep/down/single", "empty", "i32", "i64", "name",
                                           "names", "real", "scalar", "u64", "u8"));
  EXPECT_EQ(file.TypeName("real"), "float64");
  EXPECT_EQ(file.TypeName("u8"), "uint8");
  EXPECT_EQ(file.TypeName("names"), "string");
  EXPECT_TRUE(file.Has("deep/down/single"));
  EXPECT_FALSE(file.Has("deep/up"));
}

TEST(H5Inspect, DescriptionShowsFormatUnitsAndRanges) {
  const std::string path = Path("describe.h5");
  WriteSample(path);
  const std::string text = DescribeH5(path);
  EXPECT_THAT(text, HasSubstr("dexremoe.test version 3"));
  EXPECT_THAT(text, HasSubstr("test_tool"));
  EXPECT_THAT(text, HasSubstr("10 datasets"));
  EXPECT_THAT(text, HasSubstr("(2 not finite)"));
  EXPECT_THAT(text, HasSubstr("= 2.5"));
  EXPECT_THAT(text, HasSubstr("\"alpha\""));
  EXPECT_EQ(PrintH5Values(path, "i32"), "-2147483648\n2147483647\n");
  EXPECT_EQ(PrintH5Values(path, "real"), "1.5 -0 nan\ninf 5e-324 6\n");
  EXPECT_EQ(PrintH5Values(path, "names"), "alpha\n\nγ delta\n");
  EXPECT_THROW(PrintH5Values(path, "absent"), Error);
}

TEST(H5Inspect, EqualFilesCompareEqualAndOptionsAreOnlyNoted) {
  WriteSample(Path("a.h5"));
  WriteSample(Path("b.h5"), 1.5, 7, "a = 2\n");
  const H5Comparison same = CompareH5(Path("a.h5"), Path("b.h5"), 0);
  EXPECT_THAT(same.differences, IsEmpty());  // NaN equals NaN
  EXPECT_THAT(same.notes, ElementsAre(HasSubstr("'a = 1' against 'a = 2'")));
}

TEST(H5Inspect, DifferencesAreFoundWithTheirSizeAndPlace) {
  WriteSample(Path("a.h5"));
  WriteSample(Path("b.h5"), 1.75, 8);
  EXPECT_THAT(CompareH5(Path("a.h5"), Path("b.h5"), 0).differences,
              ElementsAre(HasSubstr("seed: 7 against 8"),
                          AllOf(HasSubstr("real: largest difference 0.25 at [0, 0]"),
                                HasSubstr("1.5 against 1.75"))));
  EXPECT_THAT(CompareH5(Path("a.h5"), Path("b.h5"), 0.25).differences, SizeIs(1));  // the seed
  EXPECT_THAT(CompareH5(Path("a.h5"), Path("b.h5"), 0.24).differences, SizeIs(2));
}

TEST(H5Inspect, MissingDatasetsTypesExtentsAndLargeIntegersDiffer) {
  const auto write = [](const std::string& path, auto value, std::int64_t rows, bool extra) {
    H5Writer file(path, kFormat, {"t", "", 1, {}});
    file.Write("x", std::vector<decltype(value)>(rows, value), {rows}, kDoc);
    if (extra) file.WriteString("extra", "text", kDoc);
    file.Commit();
  };
  write(Path("a.h5"), 1.0, 2, false);
  write(Path("b.h5"), 1.0f, 2, true);
  EXPECT_THAT(CompareH5(Path("a.h5"), Path("b.h5"), 0).differences,
              ElementsAre(HasSubstr("extra: only in"), HasSubstr("x: type float64 against")));
  write(Path("b.h5"), 1.0, 3, false);
  EXPECT_THAT(CompareH5(Path("a.h5"), Path("b.h5"), 9).differences,
              ElementsAre(HasSubstr("x: extents [2] against [3]")));
  // A group in one file, a dataset in the other.
  H5Writer file(Path("b.h5"), kFormat, {"t", "", 1, {}});
  file.WriteScalar("x/y", 1.0, kDoc);
  file.Commit();
  EXPECT_THAT(CompareH5(Path("a.h5"), Path("b.h5"), 0).differences,
              ElementsAre(HasSubstr("x: only in"), HasSubstr("x/y: only in")));
  // Neighbours beyond 2^53 are equal as doubles.
  write(Path("a.h5"), std::uint64_t{1} << 60, 1, false);
  write(Path("b.h5"), (std::uint64_t{1} << 60) + 1, 1, false);
  EXPECT_THAT(CompareH5(Path("a.h5"), Path("b.h5"), 0).differences, SizeIs(1));
}

}  // namespace
}  // namespace dexremoe
