// Measured numbers and the tables made of them.
#pragma once

#include <span>
#include <string>
#include <vector>

namespace dexremoe {

// One number of a table, at a row and a column that are named by their text.
struct Measurement {
  std::string table;   // "joint"
  std::string row;     // "lanes 2x2x3"
  std::string column;  // "0.3 rad", with the unit of the value where it is not the table's
  double value = 0;    // NaN: could not be measured, shown as "-"
  int decimals = 2;    // shown
  std::string spread;  // shown behind the value: "[1.1, 1.3]"; may be empty
};

// The measurements of one table as Markdown: rows and columns in the order in which they first
// appear; cells without a measurement stay empty. `corner` is the first header. Empty when the
// table has no measurements.
std::string MarkdownOf(std::span<const Measurement> all, const std::string& table,
                       const std::string& corner);

// table,row,column,value,spread; one line each. NaN is an empty value.
std::string CsvOf(std::span<const Measurement> all);

// The processor's name and the number of processors that threads may use, as one line.
std::string MachineText();

}  // namespace dexremoe
