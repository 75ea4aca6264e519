// Prints what one of the project's HDF5 files holds and where it comes from.
#include <cstdio>
#include <string>

#include "base/options.h"
#include "io/h5_inspect.h"

int main(int argc, char** argv) {
  std::string file, values;
  dexremoe::Options options(
      "h5_info",
      "Prints format, provenance and datasets (type, extents, unit, range) of "
      "an HDF5 file of this project.",
      "h5_info --file=results/quick/eval/base.h5");
  options.Add("file", &file, "HDF5 file to look into").Required();
  options.Add("values", &values, "print the values of this dataset instead, one row a line");
  return dexremoe::RunTool(options, argc, argv, [&] {
    const std::string text =
        values.empty() ? dexremoe::DescribeH5(file) : dexremoe::PrintH5Values(file, values);
    std::fputs(text.c_str(), stdout);
  });
}
