#include "io/csv.h"

#include <algorithm>
#include <cstdlib>
#include <string_view>

#include "base/check.h"
#include "base/error.h"
#include "io/atomic_file.h"

namespace dexremoe {
namespace {

// Splits one line; a quoted field may hold commas and doubled quotes, not line breaks.
std::vector<std::string> SplitLine(std::string_view line, const std::string& path, int number) {
  std::vector<std::string> fields(1);
  bool quoted = false;
  for (std::size_t i = 0; i < line.size(); ++i) {
    const char c = line[i];
    if (quoted && c == '"' && i + 1 < line.size() && line[i + 1] == '"') {
      fields.back() += '"';
      ++i;
    } else if (c == '"' && (quoted || fields.back().empty())) {
      quoted = !quoted;
    } else if (c == ',' && !quoted) {
      fields.emplace_back();
    } else {
      fields.back() += c;
    }
  }
  if (quoted) Fail("{}: line {}: a quote is not closed", path, number);
  return fields;
}

std::string Quoted(const std::string& field) {
  if (field.find_first_of(",\"\n") == std::string::npos) return field;
  std::string text = "\"";
  for (const char c : field) text += c == '"' ? std::string("\"\"") : std::string(1, c);
  return text + '"';
}

}  // namespace

CsvTable CsvTable::Read(const std::string& path) {
  const std::string bytes = ReadFile(path);
  CsvTable table;
  table.path_ = path;
  int number = 0;
  for (std::size_t begin = 0; begin < bytes.size();) {
    const std::size_t end = std::min(bytes.find('\n', begin), bytes.size());
    std::string_view line(bytes.data() + begin, end - begin);
    begin = end + 1;
    ++number;
    if (line.ends_with('\r')) line.remove_suffix(1);
    if (line.empty() || line.starts_with('#')) continue;
    std::vector<std::string> fields = SplitLine(line, path, number);
    if (table.columns_.empty()) {
      table.columns_ = std::move(fields);
      continue;
    }
    if (fields.size() != table.columns_.size())
      Fail("{}: line {}: expected {} fields, found {}", path, number, table.columns_.size(),
           fields.size());
    table.rows_.push_back(std::move(fields));
    table.line_.push_back(number);
  }
  if (table.columns_.empty()) Fail("{}: expected a header line, found an empty file", path);
  return table;
}

std::size_t CsvTable::ColumnIndex(const std::string& name) const {
  const auto found = std::find(columns_.begin(), columns_.end(), name);
  if (found == columns_.end()) {
    std::string known;
    for (const std::string& column : columns_) known += (known.empty() ? "" : ", ") + column;
    Fail("{}: column '{}' is missing; found {}", path_, name, known);
  }
  return static_cast<std::size_t>(found - columns_.begin());
}

bool CsvTable::HasColumn(const std::string& name) const {
  return std::find(columns_.begin(), columns_.end(), name) != columns_.end();
}

std::vector<std::string> CsvTable::Text(const std::string& column) const {
  const std::size_t index = ColumnIndex(column);
  std::vector<std::string> values;
  values.reserve(rows_.size());
  for (const std::vector<std::string>& row : rows_) values.push_back(row[index]);
  return values;
}

std::vector<double> CsvTable::Numbers(const std::string& column) const {
  const std::size_t index = ColumnIndex(column);
  std::vector<double> values;
  values.reserve(rows_.size());
  for (std::size_t r = 0; r < rows_.size(); ++r) {
    const std::string& text = rows_[r][index];
    char* end = nullptr;
    const double value = std::strtod(text.c_str(), &end);
    if (text.empty() || *end != '\0')
      Fail("{}: line {}: column '{}': expected a number, found '{}'", path_, line_[r], column,
           text);
    values.push_back(value);
  }
  return values;
}

CsvWriter::CsvWriter(const std::vector<std::string>& columns) : width_(columns.size()) {
  Row(columns);
}

void CsvWriter::Row(const std::vector<std::string>& fields) {
  DEX_CHECK_EQ(fields.size(), width_);
  for (std::size_t i = 0; i < fields.size(); ++i) text_ += (i > 0 ? "," : "") + Quoted(fields[i]);
  text_ += '\n';
}

}  // namespace dexremoe
