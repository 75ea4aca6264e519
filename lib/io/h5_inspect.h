// Looking into any of our HDF5 files, and comparing two.
#pragma once

#include <string>
#include <vector>

namespace dexremoe {

// Format, provenance and every dataset with type, extents, unit, doc and, for numbers, least, mean
// and greatest value, as lines to print. Throws Error.
std::string DescribeH5(const std::string& path);
// The values of one dataset, one row of its last axis per line (texts: one per line).
std::string PrintH5Values(const std::string& path, const std::string& dataset);

struct H5Comparison {
  // One line for each dataset or attribute that differs: format, format_version, seed, presence,
  // type, extents, values beyond the tolerance.
  std::vector<std::string> differences;
  // Differences in provenance that leave the content equal: tool, version, options, inputs.
  std::vector<std::string> notes;
};
// Numbers a and b are equal when |a - b| <= tolerance, or when both are NaN. Throws Error.
H5Comparison CompareH5(const std::string& path_a, const std::string& path_b, double tolerance);

}  // namespace dexremoe
