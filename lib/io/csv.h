// Tables of text: a header line, then rows with as many fields.
#pragma once

#include <string>
#include <vector>

namespace dexremoe {

// Fields may be quoted ("a,b", "say ""x"""); lines that start with '#' and empty lines are skipped.
class CsvTable {
 public:
  // Throws Error naming file and line when a row has another number of fields than the header.
  static CsvTable Read(const std::string& path);

  std::size_t num_rows() const { return rows_.size(); }
  const std::vector<std::string>& columns() const { return columns_; }
  bool HasColumn(const std::string& name) const;
  // Throw Error naming file, column (and row) when absent or not a number. "nan" is a number.
  std::vector<std::string> Text(const std::string& column) const;
  std::vector<double> Numbers(const std::string& column) const;

 private:
  std::size_t ColumnIndex(const std::string& name) const;

  std::string path_;
  std::vector<std::string> columns_;
  std::vector<std::vector<std::string>> rows_;
  std::vector<int> line_;  // line number of each row in the file, from 1
};

// Builds a table row by row; Text() is the file's content.
class CsvWriter {
 public:
  explicit CsvWriter(const std::vector<std::string>& columns);
  // `fields` are as many as the columns; those with a comma, quote or newline are quoted.
  void Row(const std::vector<std::string>& fields);
  const std::string& text() const { return text_; }

 private:
  std::size_t width_;
  std::string text_;
};

}  // namespace dexremoe
