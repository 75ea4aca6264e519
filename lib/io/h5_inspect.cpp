#include "io/h5_inspect.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <set>
#include <sstream>

#include "base/error.h"
#include "io/h5.h"

namespace dexremoe {
namespace {

std::vector<std::int64_t> AnyExtents(const H5Reader& file, const std::string& name) {
  return std::vector<std::int64_t>(file.Dims(name).size(), -1);
}

// Calls visit(values) with the dataset's values in their own type. False for text and unknown
// types.
template <typename Visit>
bool VisitNumbers(const H5Reader& file, const std::string& name, Visit visit) {
  const std::string type = file.TypeName(name);
  const auto any = AnyExtents(file, name);
  if (type == "float64")
    visit(file.ReadValues<double>(name, any));
  else if (type == "float32")
    visit(file.ReadValues<float>(name, any));
  else if (type == "int32")
    visit(file.ReadValues<std::int32_t>(name, any));
  else if (type == "int64")
    visit(file.ReadValues<std::int64_t>(name, any));
  else if (type == "uint64")
    visit(file.ReadValues<std::uint64_t>(name, any));
  else if (type == "uint8")
    visit(file.ReadValues<std::uint8_t>(name, any));
  else
    return false;
  return true;
}

std::string ExtentsText(const std::vector<std::int64_t>& dims) {
  return fmt::format("[{}]", fmt::join(dims, ", "));
}

// "min -1 mean 0.2 max 3", or the value itself when there is one.
template <typename T>
std::string Summary(const std::vector<T>& values) {
  if (values.empty()) return "empty";
  if (values.size() == 1) return fmt::format("= {}", values.front());
  double low = HUGE_VAL, high = -HUGE_VAL, sum = 0;
  std::size_t bad = 0;
  for (const T value : values) {
    const auto x = static_cast<double>(value);
    if (!std::isfinite(x)) {
      ++bad;
      continue;
    }
    low = std::min(low, x);
    high = std::max(high, x);
    sum += x;
  }
  const std::size_t good = values.size() - bad;
  std::string text = good == 0 ? "no finite value"
                               : fmt::format("min {:.6g}  mean {:.6g}  max {:.6g}", low,
                                             sum / static_cast<double>(good), high);
  return bad > 0 ? text + fmt::format("  ({} not finite)", bad) : text;
}

std::string TextSummary(const std::vector<std::string>& values) {
  std::string text;
  for (std::size_t i = 0; i < values.size() && i < 4; ++i)
    text += (i > 0 ? ", " : "") + ('"' + values[i].substr(0, 40) + '"');
  return values.size() > 4 ? text + ", ..." : text;
}

std::string IndentLines(const std::string& text) {
  std::string out;
  std::istringstream lines(text);
  for (std::string line; std::getline(lines, line);) out += "  " + line + "\n";
  return out;
}

std::string DescribeDataset(const H5Reader& file, const std::string& name, std::size_t width) {
  std::string summary;
  const bool number = VisitNumbers(file, name, [&](const auto& v) { summary = Summary(v); });
  if (!number)
    summary = file.TypeName(name) == "string" ? TextSummary(file.ReadStrings(name)) : "not shown";
  const std::string unit = file.DatasetAttribute(name, "unit");
  const std::string dims = file.DatasetAttribute(name, "dims");
  std::string text =
      fmt::format("{:<{}}  {:<8} {:<14} {:<8} {}\n", name, width, file.TypeName(name),
                  ExtentsText(file.Dims(name)), unit.empty() ? "-" : unit, summary);
  const std::string doc = file.DatasetAttribute(name, "doc");
  return text +
         fmt::format("{:<{}}  {}{}\n", "", width, dims.empty() ? "" : "(" + dims + ") ", doc);
}

template <typename T>
double Difference(const std::vector<T>& a, const std::vector<T>& b, std::size_t& where) {
  double largest = 0;
  for (std::size_t i = 0; i < a.size(); ++i) {
    if (a[i] == b[i]) continue;
    const auto x = static_cast<double>(a[i]), y = static_cast<double>(b[i]);
    if (std::isnan(x) && std::isnan(y)) continue;
    double d = std::abs(x - y);
    if (std::isnan(d)) d = HUGE_VAL;                     // one of them is NaN
    if (d == 0) d = std::numeric_limits<double>::min();  // integers beyond 2^53
    if (d > largest) {
      largest = d;
      where = i;
    }
  }
  return largest;
}

// "row 3, column 1" style place of a flat index.
std::string Place(std::size_t flat, const std::vector<std::int64_t>& dims) {
  std::vector<std::int64_t> index(dims.size());
  for (std::size_t k = dims.size(); k-- > 0;) {
    index[k] = static_cast<std::int64_t>(flat) % dims[k];
    flat /= static_cast<std::size_t>(dims[k]);
  }
  return ExtentsText(index);
}

void CompareDataset(const H5Reader& a, const H5Reader& b, const std::string& name, double tolerance,
                    std::vector<std::string>& differences) {
  if (a.TypeName(name) != b.TypeName(name)) {
    differences.push_back(
        fmt::format("{}: type {} against {}", name, a.TypeName(name), b.TypeName(name)));
    return;
  }
  if (a.Dims(name) != b.Dims(name)) {
    differences.push_back(fmt::format("{}: extents {} against {}", name, ExtentsText(a.Dims(name)),
                                      ExtentsText(b.Dims(name))));
    return;
  }
  const bool number = VisitNumbers(a, name, [&]<typename T>(const std::vector<T>& x) {
    const auto y = b.ReadValues<T>(name, AnyExtents(b, name));
    std::size_t where = 0;
    const double largest = Difference(x, y, where);
    if (largest > tolerance)
      differences.push_back(fmt::format("{}: largest difference {:.6g} at {}: {} against {}", name,
                                        largest, Place(where, a.Dims(name)), x[where], y[where]));
  });
  if (number) return;
  const auto x = a.ReadStrings(name), y = b.ReadStrings(name);
  for (std::size_t i = 0; i < x.size(); ++i) {
    if (x[i] == y[i]) continue;
    differences.push_back(fmt::format("{}: text {}: \"{}\" against \"{}\"", name, i, x[i], y[i]));
    break;
  }
}

// The first line in which two texts differ.
std::string FirstDifference(const std::string& a, const std::string& b) {
  std::istringstream lines_a(a), lines_b(b);
  for (;;) {
    std::string x, y;
    const bool more_a = static_cast<bool>(std::getline(lines_a, x));
    const bool more_b = static_cast<bool>(std::getline(lines_b, y));
    if (!more_a && !more_b) return "line ends";
    if (x != y || more_a != more_b) return fmt::format("'{}' against '{}'", x, y);
  }
}

}  // namespace

std::string DescribeH5(const std::string& path) {
  const H5Reader file(path);
  std::string text =
      fmt::format("{} version {}\n", file.Attribute("format"), file.Attribute("format_version"));
  text += fmt::format("made by {} {} with seed {}\n", file.Attribute("tool"),
                      file.Attribute("version"), file.Attribute("seed"));
  if (const std::string inputs = file.Attribute("inputs"); !inputs.empty())
    text += "inputs (name, xxh3-128):\n" + IndentLines(inputs);
  if (const std::string options = file.Attribute("options"); !options.empty())
    text += "options:\n" + IndentLines(options);
  const std::vector<std::string> names = file.Datasets();
  std::size_t width = 0;
  for (const std::string& name : names) width = std::max(width, name.size());
  text += fmt::format("{} datasets:\n", names.size());
  for (const std::string& name : names) text += IndentLines(DescribeDataset(file, name, width));
  return text;
}

std::string PrintH5Values(const std::string& path, const std::string& dataset) {
  const H5Reader file(path);
  if (!file.Has(dataset)) Fail("{}: dataset '{}' is missing", path, dataset);
  const std::vector<std::int64_t> dims = file.Dims(dataset);
  const auto width =
      static_cast<std::size_t>(dims.size() < 2 ? 1 : std::max<std::int64_t>(1, dims.back()));
  std::string text;
  const bool number = VisitNumbers(file, dataset, [&](const auto& values) {
    for (std::size_t i = 0; i < values.size(); ++i)
      text += fmt::format("{}{}", values[i], (i + 1) % width == 0 ? "\n" : " ");
  });
  if (!number)
    for (const std::string& value : file.ReadStrings(dataset)) text += value + "\n";
  return text;
}

H5Comparison CompareH5(const std::string& path_a, const std::string& path_b, double tolerance) {
  const H5Reader a(path_a), b(path_b);
  H5Comparison result;
  for (const char* name : {"format", "format_version", "seed"})
    if (a.Attribute(name) != b.Attribute(name))
      result.differences.push_back(
          fmt::format("attribute {}: {} against {}", name, a.Attribute(name), b.Attribute(name)));
  for (const char* name : {"tool", "version", "options", "inputs"})
    if (a.Attribute(name) != b.Attribute(name))
      result.notes.push_back(fmt::format("attribute {}: {}", name,
                                         FirstDifference(a.Attribute(name), b.Attribute(name))));
  const std::vector<std::string> names_a = a.Datasets(), names_b = b.Datasets();
  std::set<std::string> names(names_a.begin(), names_a.end());
  names.insert(names_b.begin(), names_b.end());
  for (const std::string& name : names) {
    const bool in_a = std::binary_search(names_a.begin(), names_a.end(), name);
    const bool in_b = std::binary_search(names_b.begin(), names_b.end(), name);
    if (in_a && in_b)
      CompareDataset(a, b, name, tolerance, result.differences);
    else
      result.differences.push_back(fmt::format("{}: only in {}", name, in_a ? path_a : path_b));
  }
  return result;
}

}  // namespace dexremoe
