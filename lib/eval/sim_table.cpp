#include "eval/sim_table.h"

#include <spdlog/fmt/fmt.h>

#include <algorithm>
#include <cmath>
#include <fstream>
#include <thread>

#include "io/csv.h"

namespace dexremoe {
namespace {

std::size_t IndexOf(std::vector<std::string>& names, const std::string& name) {
  const auto found = std::find(names.begin(), names.end(), name);
  if (found != names.end()) return found - names.begin();
  names.push_back(name);
  return names.size() - 1;
}

std::string Cell(const Measurement& m) {
  if (std::isnan(m.value)) return "-";
  std::string text = fmt::format("{:.{}f}", m.value, m.decimals);
  return m.spread.empty() ? text : text + " " + m.spread;
}

std::string Line(const std::vector<std::string>& cells, const std::vector<std::size_t>& width) {
  std::string line = "|";
  for (std::size_t c = 0; c < cells.size(); ++c)
    line += c == 0 ? fmt::format(" {:<{}} |", cells[c], width[c])
                   : fmt::format(" {:>{}} |", cells[c], width[c]);
  return line + "\n";
}

}  // namespace

std::string MarkdownOf(std::span<const Measurement> all, const std::string& table,
                       const std::string& corner) {
  std::vector<std::string> rows, columns = {corner};
  std::vector<std::vector<std::string>> cells(1);
  for (const Measurement& m : all) {
    if (m.table != table) continue;
    const std::size_t row = IndexOf(rows, m.row) + 1, column = IndexOf(columns, m.column);
    if (cells.size() <= row) cells.push_back({m.row});
    if (cells[row].size() <= column) cells[row].resize(column + 1);
    cells[row][column] = Cell(m);
  }
  if (rows.empty()) return {};
  cells[0] = columns;
  std::vector<std::size_t> width(columns.size(), 3);
  for (auto& line : cells) {
    line.resize(columns.size());
    for (std::size_t c = 0; c < line.size(); ++c) width[c] = std::max(width[c], line[c].size());
  }
  std::string text = Line(cells[0], width) + "|";
  for (std::size_t c = 0; c < width.size(); ++c)
    text +=
        c == 0 ? ":" + std::string(width[c] + 1, '-') + "|" : std::string(width[c] + 1, '-') + ":|";
  text += "\n";
  for (std::size_t l = 1; l < cells.size(); ++l) text += Line(cells[l], width);
  return text;
}

std::string CsvOf(std::span<const Measurement> all) {
  CsvWriter csv({"table", "row", "column", "value", "spread"});
  for (const Measurement& m : all)
    csv.Row({m.table, m.row, m.column,
             std::isnan(m.value) ? std::string() : fmt::format("{:.6g}", m.value), m.spread});
  return csv.text();
}

std::string MachineText() {
  std::string model = "unknown processor";
  std::ifstream info("/proc/cpuinfo");
  for (std::string line; std::getline(info, line);)
    if (line.starts_with("model name") && line.find(": ") != std::string::npos) {
      model = line.substr(line.find(": ") + 2);
      break;
    }
  return fmt::format("{}, {} processors", model, std::thread::hardware_concurrency());
}

}  // namespace dexremoe
