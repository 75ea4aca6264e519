// Compares two of the project's HDF5 files: silent and exit 0 when their content is equal.
#include <cstdio>
#include <string>

#include "base/log.h"
#include "base/options.h"
#include "io/h5_inspect.h"

int main(int argc, char** argv) {
  std::string a, b;
  double tolerance = 0;
  dexremoe::Options options(
      "h5_diff",
      "Compares two HDF5 files of this project. Silent and exit 0 when equal; "
      "else lists what differs and exits 1.",
      "h5_diff --a=run1/base.h5 --b=run2/base.h5 --tolerance=1e-6");
  options.Add("a", &a, "first file").Required();
  options.Add("b", &b, "second file").Required();
  options.Add("tolerance", &tolerance, "largest difference of two numbers that counts as equal")
      .Range(0, 1e300);
  bool equal = true;
  const int code = dexremoe::RunTool(options, argc, argv, [&] {
    const dexremoe::H5Comparison result = dexremoe::CompareH5(a, b, tolerance);
    for (const std::string& line : result.differences) std::puts(line.c_str());
    for (const std::string& line : result.notes) dexremoe::LogInfo("{}", line);
    equal = result.differences.empty();
  });
  return code != 0 ? code : (equal ? 0 : 1);
}
