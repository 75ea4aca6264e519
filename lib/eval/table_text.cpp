// The three ways to write a table: Markdown with padded columns, LaTeX (booktabs), CSV.
#include <algorithm>
#include <cmath>

#include "base/error.h"
#include "eval/tables.h"
#include "io/csv.h"

namespace dexremoe {
namespace {

// Lengths and other large numbers need no decimals.
std::string Number(Metric column, double x) {
  return column == Metric::kLength ? fmt::format("{:.0f}", x) : fmt::format("{:.2f}", x);
}

std::string Cell(Metric column, const Estimate& e) {
  if (std::isnan(e.value)) return "-";
  if (std::isnan(e.low)) return Number(column, e.value);
  return fmt::format("{} [{}, {}]", Number(column, e.value), Number(column, e.low),
                     Number(column, e.high));
}

// Characters that a terminal shows (bytes that do not continue a UTF-8 sequence).
std::size_t ShownWidth(const std::string& text) {
  return std::count_if(text.begin(), text.end(), [](char c) { return (c & 0xC0) != 0x80; });
}

// All lines of a table as cells, the header first.
std::vector<std::vector<std::string>> Cells(const ResultTable& table) {
  std::vector<std::vector<std::string>> lines(1, {"Method"});
  for (const TableColumn& column : table.columns) lines[0].push_back(column.label());
  for (const TableRow& row : table.rows) {
    lines.push_back({row.paper ? row.label + " (paper)" : row.label});
    for (std::size_t c = 0; c < row.values.size(); ++c)
      lines.back().push_back(row.missing ? "missing"
                                         : Cell(table.columns[c].metric, row.values[c]));
  }
  return lines;
}

std::string MarkdownLine(const std::vector<std::string>& cells,
                         const std::vector<std::size_t>& width) {
  std::string line = "|";
  for (std::size_t c = 0; c < cells.size(); ++c) {
    const std::string pad(width[c] - ShownWidth(cells[c]), ' ');
    line += c == 0 ? " " + cells[c] + pad + " |" : " " + pad + cells[c] + " |";
  }
  return line + "\n";
}

std::string MarkdownTable(const ResultTable& table) {
  const auto lines = Cells(table);
  std::vector<std::size_t> width(lines[0].size(), 3);
  for (const auto& line : lines)
    for (std::size_t c = 0; c < line.size(); ++c)
      width[c] = std::max(width[c], ShownWidth(line[c]));
  std::string text = MarkdownLine(lines[0], width) + "|";
  for (std::size_t c = 0; c < width.size(); ++c)
    text +=
        c == 0 ? ":" + std::string(width[c] + 1, '-') + "|" : std::string(width[c] + 1, '-') + ":|";
  text += "\n";
  for (std::size_t l = 1; l < lines.size(); ++l) text += MarkdownLine(lines[l], width);
  return text;
}

bool HasPaperRows(const ResultTable& table) {
  return std::any_of(table.rows.begin(), table.rows.end(),
                     [](const TableRow& row) { return row.paper; });
}

const char* kPaperRemark =
    "Rows marked (paper) are the numbers printed there: another simulator, other meshes, 100 "
    "training "
    "and 50 other objects.";

std::string LatexEscaped(const std::string& text) {
  std::string out;
  for (const char c : text) {
    if (std::string("&%$#_{}").find(c) != std::string::npos) out += '\\';
    out += c;
  }
  return out;
}

std::string LatexHeader(const TableColumn& column) {
  if (!column.category.empty()) return LatexEscaped(column.category);
  switch (column.metric) {
    case Metric::kMin:
      return "$S_{\\min}$";
    case Metric::kMax:
      return "$S_{\\max}$";
    case Metric::kWorst5:
      return "$\\bar S_{5-}$";
    case Metric::kBest5:
      return "$\\bar S_{5+}$";
    case Metric::kMean:
      return "$\\bar S$";
    default:
      return LatexEscaped(column.label());
  }
}

std::string LatexCell(Metric column, const Estimate& e) {
  if (std::isnan(e.value)) return "--";
  if (std::isnan(e.low)) return Number(column, e.value);
  return fmt::format("{} {{\\scriptsize[{}, {}]}}", Number(column, e.value), Number(column, e.low),
                     Number(column, e.high));
}

std::string LatexTable(const ResultTable& table) {
  std::string text = "\\begin{table*}\n\\centering\n\\begin{tabular}{l" +
                     std::string(table.columns.size(), 'r') + "}\n\\toprule\nMethod";
  for (const TableColumn& column : table.columns) text += " & " + LatexHeader(column);
  text += " \\\\\n\\midrule\n";
  bool paper = false;
  for (const TableRow& row : table.rows) {
    if (row.paper && !paper) text += "\\midrule\n";
    paper = row.paper;
    text += LatexEscaped(row.paper ? row.label + " (paper)" : row.label);
    if (row.missing)
      text += fmt::format(" & \\multicolumn{{{}}}{{c}}{{missing}}", row.values.size());
    for (std::size_t c = 0; !row.missing && c < row.values.size(); ++c)
      text += " & " + LatexCell(table.columns[c].metric, row.values[c]);
    text += " \\\\\n";
  }
  text += "\\bottomrule\n\\end{tabular}\n\\caption{" + LatexEscaped(table.caption) +
          (HasPaperRows(table) ? " " + LatexEscaped(kPaperRemark) : "") + "}\n\\end{table*}\n";
  return text;
}

std::string Title(const ResultTable& table) {
  return fmt::format("{}, tolerance {} rad",
                     table.split == "train" ? "Training objects" : "Out-of-distribution objects",
                     table.tolerance);
}

}  // namespace

std::string MarkdownOf(const std::vector<ResultTable>& tables) {
  std::string text;
  for (const ResultTable& table : tables) {
    text += (text.empty() ? "## " : "\n## ") + Title(table) + "\n\n" + MarkdownTable(table) + "\n" +
            table.caption + (HasPaperRows(table) ? std::string(" ") + kPaperRemark : "") + "\n";
  }
  return text;
}

std::string LatexOf(const std::vector<ResultTable>& tables) {
  std::string text = "% needs \\usepackage{booktabs}\n";
  for (const ResultTable& table : tables) text += LatexTable(table);
  return text;
}

std::string CsvOf(const std::vector<ResultTable>& tables) {
  CsvWriter csv({"split", "tolerance", "source", "method", "metric", "value", "low", "high"});
  const auto number = [](double x) {
    return std::isnan(x) ? std::string() : fmt::format("{:.6g}", x);
  };
  for (const ResultTable& table : tables)
    for (const TableRow& row : table.rows)
      for (std::size_t c = 0; c < row.values.size(); ++c) {
        const Estimate& e = row.values[c];
        if (std::isnan(e.value) && !row.missing) continue;
        csv.Row({table.split, fmt::format("{}", table.tolerance),
                 row.paper     ? "paper"
                 : row.missing ? "missing"
                               : "ours",
                 row.label, table.columns[c].name(), number(e.value), number(e.low),
                 number(e.high)});
      }
  return csv.text();
}

}  // namespace dexremoe
