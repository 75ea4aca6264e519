// HDF5 files: read with checks, written whole or not at all.
//
// Root attributes of every file: format, format_version, tool, version, options, seed, inputs.
// Every dataset has the attributes unit, dims and doc. Object times are off and strings are of
// fixed length, so two equal runs give equal bytes.
#pragma once

#include <cstdint>
#include <string>
#include <vector>

#include "base/options.h"

namespace dexremoe {

// What kind of file it is; readers check both. Each module names its own formats.
struct H5Format {
  const char* name;  // e.g. "dexremoe.mesh"
  int version;
};

// Where a file comes from.
struct Provenance {
  std::string tool;
  std::string options;  // Options::Text()
  std::uint64_t seed = 0;
  std::vector<std::string> inputs;  // paths; stored as "basename xxh3-128" lines
};

Provenance MakeProvenance(const Options& options, std::uint64_t seed,
                          std::vector<std::string> inputs);

// What a dataset means.
struct H5Doc {
  const char* unit;  // "m", "rad", "1", ...
  const char* dims;  // names of the axes: "object, component"
  const char* doc;
};

template <typename T>
struct H5Array {
  std::vector<std::int64_t> dims;  // row-major
  std::vector<T> values;
};

// Element types T below: double, float, std::int32_t, std::int64_t, std::uint64_t, std::uint8_t.
class H5Writer {
 public:
  H5Writer(std::string path, H5Format format, const Provenance& provenance);
  ~H5Writer();  // removes what was not committed
  H5Writer(const H5Writer&) = delete;
  H5Writer& operator=(const H5Writer&) = delete;

  // `name` may contain '/'; groups are made as needed. The product of dims is values.size().
  template <typename T>
  void Write(const std::string& name, const std::vector<T>& values,
             const std::vector<std::int64_t>& dims, const H5Doc& doc);
  template <typename T>
  void WriteScalar(const std::string& name, T value, const H5Doc& doc) {
    Write(name, std::vector<T>{value}, {}, doc);
  }
  void WriteStrings(const std::string& name, const std::vector<std::string>& values,
                    const H5Doc& doc);
  void WriteString(const std::string& name, const std::string& value, const H5Doc& doc) {
    WriteStrings(name, {value}, doc);
  }
  void Commit();

 private:
  void Discard();
  std::string path_, temporary_;
  std::int64_t file_ = -1;
};

class H5Reader {
 public:
  // Throws Error when the file is missing, not HDF5, or of another format or version.
  H5Reader(std::string path, H5Format format);
  // Any of our files, whatever its format (h5_info, h5_diff).
  explicit H5Reader(std::string path);
  ~H5Reader();
  H5Reader(const H5Reader&) = delete;
  H5Reader& operator=(const H5Reader&) = delete;

  const std::string& path() const { return path_; }
  bool Has(const std::string& name) const;
  // `dims` are the expected extents, -1 for any. Throws Error naming file, dataset, expected,
  // found.
  template <typename T>
  H5Array<T> Read(const std::string& name, const std::vector<std::int64_t>& dims) const;
  template <typename T>
  std::vector<T> ReadValues(const std::string& name, const std::vector<std::int64_t>& dims) const {
    return Read<T>(name, dims).values;
  }
  template <typename T>
  T ReadScalar(const std::string& name) const {
    return Read<T>(name, {}).values.front();
  }
  std::vector<std::string> ReadStrings(const std::string& name) const;
  std::string ReadString(const std::string& name) const;

  // Root attributes.
  std::string Attribute(const std::string& name) const;
  // All datasets by path, sorted.
  std::vector<std::string> Datasets() const;
  std::vector<std::int64_t> Dims(const std::string& name) const;
  // "float64", "int32", "string", ...
  std::string TypeName(const std::string& name) const;
  // unit, dims or doc of a dataset.
  std::string DatasetAttribute(const std::string& name, const std::string& attribute) const;

 private:
  void Open();
  std::string path_;
  std::int64_t file_ = -1;
};

}  // namespace dexremoe
