#include "io/h5.h"

#include <hdf5.h>
#include <xxhash.h>

#include <algorithm>
#include <filesystem>
#include <numeric>
#include <type_traits>

#include "base/check.h"
#include "base/error.h"
#include "base/version.h"
#include "io/atomic_file.h"

namespace dexremoe {
namespace {

// Closes an HDF5 identifier with its own function.
class Handle {
 public:
  Handle(hid_t id, herr_t (*close)(hid_t)) : id_(id), close_(close) {}
  ~Handle() {
    if (id_ >= 0) close_(id_);
  }
  Handle(const Handle&) = delete;
  Handle& operator=(const Handle&) = delete;
  operator hid_t() const { return id_; }  // NOLINT: passed straight to HDF5

 private:
  hid_t id_;
  herr_t (*close_)(hid_t);
};

template <typename T>
hid_t NativeType() {
  if constexpr (std::is_same_v<T, double>) return H5T_NATIVE_DOUBLE;
  if constexpr (std::is_same_v<T, float>) return H5T_NATIVE_FLOAT;
  if constexpr (std::is_same_v<T, std::int32_t>) return H5T_NATIVE_INT32;
  if constexpr (std::is_same_v<T, std::int64_t>) return H5T_NATIVE_INT64;
  if constexpr (std::is_same_v<T, std::uint64_t>) return H5T_NATIVE_UINT64;
  if constexpr (std::is_same_v<T, std::uint8_t>) return H5T_NATIVE_UINT8;
}

std::string TypeText(hid_t type) {
  const H5T_class_t kind = H5Tget_class(type);
  if (kind == H5T_STRING) return "string";
  const std::size_t bits = 8 * H5Tget_size(type);
  if (kind == H5T_FLOAT) return fmt::format("float{}", bits);
  if (kind == H5T_INTEGER)
    return fmt::format("{}{}", H5Tget_sign(type) == H5T_SGN_NONE ? "uint" : "int", bits);
  return "unknown";
}

std::string DimsText(const std::vector<std::int64_t>& dims) {
  std::string text;
  for (const std::int64_t d : dims) text += (text.empty() ? "" : ", ") + (d < 0 ? "any" : fmt::format("{}", d));
  return "[" + text + "]";
}

void WriteAttribute(hid_t object, const std::string& path, const std::string& name,
                    const std::string& value) {
  constexpr std::size_t kLimit = 64000;  // HDF5 keeps attributes of up to 64 KiB
  if (value.size() > kLimit)
    Fail("{}: attribute '{}': expected at most {} bytes, found {}", path, name, kLimit,
         value.size());
  const Handle type(H5Tcopy(H5T_C_S1), H5Tclose);
  H5Tset_size(type, std::max<std::size_t>(1, value.size()));
  H5Tset_strpad(type, H5T_STR_NULLPAD);
  const Handle space(H5Screate(H5S_SCALAR), H5Sclose);
  const Handle attribute(H5Acreate2(object, name.c_str(), type, space, H5P_DEFAULT, H5P_DEFAULT),
                         H5Aclose);
  const std::string padded = value.empty() ? std::string(1, '\0') : value;
  if (attribute < 0 || H5Awrite(attribute, type, padded.data()) < 0)
    Fail("{}: attribute '{}' cannot be written", path, name);
}

std::string ReadAttribute(hid_t object, const std::string& path, const std::string& name) {
  if (H5Aexists(object, name.c_str()) <= 0)
    Fail("{}: attribute '{}' is missing; not a file of this project", path, name);
  const Handle attribute(H5Aopen(object, name.c_str(), H5P_DEFAULT), H5Aclose);
  const Handle type(H5Aget_type(attribute), H5Tclose);
  if (H5Tget_class(type) != H5T_STRING || H5Tis_variable_str(type) > 0)
    Fail("{}: attribute '{}': expected text of fixed length, found another type", path, name);
  std::string value(H5Tget_size(type), '\0');
  if (H5Aread(attribute, type, value.data()) < 0) Fail("{}: attribute '{}' is unreadable", path, name);
  value.resize(value.find_last_not_of('\0') + 1);
  return value;
}

std::string HashLine(const std::string& path) {
  const std::string bytes = ReadFile(path);
  const XXH128_hash_t hash = XXH3_128bits(bytes.data(), bytes.size());
  return fmt::format("{} {:016x}{:016x}\n", std::filesystem::path(path).filename().string(),
                     hash.high64, hash.low64);
}

std::vector<std::int64_t> Extents(hid_t space) {
  const int rank = H5Sget_simple_extent_ndims(space);
  std::vector<hsize_t> dims(std::max(rank, 0));
  if (rank > 0) H5Sget_simple_extent_dims(space, dims.data(), nullptr);
  return {dims.begin(), dims.end()};
}

std::int64_t Count(const std::vector<std::int64_t>& dims) {
  return std::accumulate(dims.begin(), dims.end(), std::int64_t{1}, std::multiplies<>());
}

hid_t CreateDataset(hid_t file, const std::string& name, hid_t type,
                    const std::vector<std::int64_t>& dims) {
  const std::vector<hsize_t> extents(dims.begin(), dims.end());
  const Handle space(dims.empty() ? H5Screate(H5S_SCALAR)
                                  : H5Screate_simple(static_cast<int>(dims.size()), extents.data(),
                                                     nullptr),
                     H5Sclose);
  const Handle links(H5Pcreate(H5P_LINK_CREATE), H5Pclose);
  H5Pset_create_intermediate_group(links, 1);
  const Handle creation(H5Pcreate(H5P_DATASET_CREATE), H5Pclose);
  H5Pset_obj_track_times(creation, false);
  return H5Dcreate2(file, name.c_str(), type, space, links, creation, H5P_DEFAULT);
}

void WriteDoc(hid_t dataset, const std::string& path, const H5Doc& doc) {
  WriteAttribute(dataset, path, "unit", doc.unit);
  WriteAttribute(dataset, path, "dims", doc.dims);
  WriteAttribute(dataset, path, "doc", doc.doc);
}

void WriteRootAttributes(hid_t file, const std::string& path, const H5Format& format,
                         const Provenance& provenance, const std::string& inputs) {
  WriteAttribute(file, path, "format", format.name);
  WriteAttribute(file, path, "format_version", fmt::format("{}", format.version));
  WriteAttribute(file, path, "tool", provenance.tool);
  WriteAttribute(file, path, "version", kVersion);
  WriteAttribute(file, path, "options", provenance.options);
  WriteAttribute(file, path, "seed", fmt::format("{}", provenance.seed));
  WriteAttribute(file, path, "inputs", inputs);
}

}  // namespace

Provenance MakeProvenance(const Options& options, std::uint64_t seed,
                          std::vector<std::string> inputs) {
  return {options.tool(), options.Text(), seed, std::move(inputs)};
}

H5Writer::H5Writer(std::string path, H5Format format, const Provenance& provenance)
    : path_(std::move(path)), temporary_(PrepareTemporary(path_)) {
  H5Eset_auto2(H5E_DEFAULT, nullptr, nullptr);
  std::string inputs;
  for (const std::string& input : provenance.inputs) inputs += HashLine(input);
  file_ = H5Fcreate(temporary_.c_str(), H5F_ACC_TRUNC, H5P_DEFAULT, H5P_DEFAULT);
  if (file_ < 0) Fail("{}: cannot be created", path_);
  try {
    WriteRootAttributes(file_, path_, format, provenance, inputs);
  } catch (...) {
    Discard();
    throw;
  }
}

H5Writer::~H5Writer() { Discard(); }

void H5Writer::Discard() {
  if (file_ < 0) return;
  H5Fclose(file_);
  file_ = -1;
  std::error_code ignored;
  std::filesystem::remove(temporary_, ignored);
}

template <typename T>
void H5Writer::Write(const std::string& name, const std::vector<T>& values,
                     const std::vector<std::int64_t>& dims, const H5Doc& doc) {
  DEX_CHECK_EQ(static_cast<std::int64_t>(values.size()), Count(dims));
  const Handle dataset(CreateDataset(file_, name, NativeType<T>(), dims), H5Dclose);
  if (dataset < 0) Fail("{}: dataset '{}' cannot be created", path_, name);
  if (!values.empty() &&
      H5Dwrite(dataset, NativeType<T>(), H5S_ALL, H5S_ALL, H5P_DEFAULT, values.data()) < 0)
    Fail("{}: dataset '{}' cannot be written", path_, name);
  WriteDoc(dataset, path_, doc);
}

void H5Writer::WriteStrings(const std::string& name, const std::vector<std::string>& values,
                            const H5Doc& doc) {
  std::size_t width = 1;
  for (const std::string& value : values) width = std::max(width, value.size());
  std::string packed;
  for (const std::string& value : values) packed += value + std::string(width - value.size(), '\0');
  const Handle type(H5Tcopy(H5T_C_S1), H5Tclose);
  H5Tset_size(type, width);
  H5Tset_strpad(type, H5T_STR_NULLPAD);
  const Handle dataset(
      CreateDataset(file_, name, type, {static_cast<std::int64_t>(values.size())}), H5Dclose);
  if (dataset < 0) Fail("{}: dataset '{}' cannot be created", path_, name);
  if (!values.empty() &&
      H5Dwrite(dataset, type, H5S_ALL, H5S_ALL, H5P_DEFAULT, packed.data()) < 0)
    Fail("{}: dataset '{}' cannot be written", path_, name);
  WriteDoc(dataset, path_, doc);
}

void H5Writer::Commit() {
  const bool flushed = H5Fflush(file_, H5F_SCOPE_GLOBAL) >= 0;
  const bool closed = H5Fclose(file_) >= 0;
  file_ = -1;
  if (!flushed || !closed) {
    std::error_code ignored;
    std::filesystem::remove(temporary_, ignored);
    Fail("{}: cannot be written (disk full?)", path_);
  }
  CommitTemporary(temporary_, path_);
}

H5Reader::H5Reader(std::string path) : path_(std::move(path)) { Open(); }

H5Reader::H5Reader(std::string path, H5Format format) : path_(std::move(path)) {
  Open();
  try {
    const std::string name = Attribute("format");
    if (name != format.name) Fail("{}: expected format {}, found {}", path_, format.name, name);
    const std::string version = Attribute("format_version");
    if (version != fmt::format("{}", format.version))
      Fail("{}: expected {} version {}, found version {}; make it anew", path_, format.name,
           format.version, version);
  } catch (...) {
    H5Fclose(file_);
    throw;
  }
}

void H5Reader::Open() {
  H5Eset_auto2(H5E_DEFAULT, nullptr, nullptr);
  if (!std::filesystem::exists(path_)) Fail("{}: no such file", path_);
  file_ = H5Fopen(path_.c_str(), H5F_ACC_RDONLY, H5P_DEFAULT);
  if (file_ < 0) Fail("{}: expected an HDF5 file, found something else or a truncated one", path_);
}

H5Reader::~H5Reader() {
  if (file_ >= 0) H5Fclose(file_);
}

bool H5Reader::Has(const std::string& name) const {
  std::string prefix;
  for (std::size_t end = 0; end != std::string::npos;) {
    end = name.find('/', end + 1);
    prefix = name.substr(0, end);
    if (H5Lexists(file_, prefix.c_str(), H5P_DEFAULT) <= 0) return false;
  }
  return true;
}

std::string H5Reader::Attribute(const std::string& name) const {
  return ReadAttribute(file_, path_, name);
}

template <typename T>
H5Array<T> H5Reader::Read(const std::string& name, const std::vector<std::int64_t>& dims) const {
  if (!Has(name)) Fail("{}: dataset '{}' is missing", path_, name);
  const Handle dataset(H5Dopen2(file_, name.c_str(), H5P_DEFAULT), H5Dclose);
  if (dataset < 0) Fail("{}: '{}': expected a dataset, found a group", path_, name);
  const Handle type(H5Dget_type(dataset), H5Tclose);
  if (TypeText(type) != TypeText(NativeType<T>()))
    Fail("{}: dataset '{}': expected {}, found {}", path_, name, TypeText(NativeType<T>()),
         TypeText(type));
  const std::vector<std::int64_t> found = Dims(name);
  bool fits = found.size() == dims.size();
  for (std::size_t i = 0; fits && i < dims.size(); ++i) fits = dims[i] < 0 || dims[i] == found[i];
  if (!fits)
    Fail("{}: dataset '{}': expected extents {}, found {}", path_, name, DimsText(dims),
         DimsText(found));
  H5Array<T> array{found, std::vector<T>(Count(found))};
  if (!array.values.empty() && H5Dread(dataset, NativeType<T>(), H5S_ALL, H5S_ALL, H5P_DEFAULT,
                                       array.values.data()) < 0)
    Fail("{}: dataset '{}' is unreadable (truncated file?)", path_, name);
  return array;
}

std::vector<std::string> H5Reader::ReadStrings(const std::string& name) const {
  if (!Has(name)) Fail("{}: dataset '{}' is missing", path_, name);
  const Handle dataset(H5Dopen2(file_, name.c_str(), H5P_DEFAULT), H5Dclose);
  const Handle type(H5Dget_type(dataset), H5Tclose);
  if (dataset < 0 || H5Tget_class(type) != H5T_STRING || H5Tis_variable_str(type) > 0)
    Fail("{}: dataset '{}': expected text of fixed length, found another type", path_, name);
  const std::size_t width = H5Tget_size(type);
  const std::int64_t count = Count(Dims(name));
  std::string packed(width * count, '\0');
  if (count > 0 && H5Dread(dataset, type, H5S_ALL, H5S_ALL, H5P_DEFAULT, packed.data()) < 0)
    Fail("{}: dataset '{}' is unreadable (truncated file?)", path_, name);
  std::vector<std::string> values(count);
  for (std::int64_t i = 0; i < count; ++i) {
    values[i] = packed.substr(i * width, width);
    values[i].resize(values[i].find_last_not_of('\0') + 1);
  }
  return values;
}

std::string H5Reader::ReadString(const std::string& name) const {
  const std::vector<std::string> values = ReadStrings(name);
  if (values.size() != 1)
    Fail("{}: dataset '{}': expected one text, found {}", path_, name, values.size());
  return values.front();
}

std::vector<std::string> H5Reader::Datasets() const {
  std::vector<std::string> names;
  const auto visit = [](hid_t, const char* name, const H5O_info_t* info, void* data) -> herr_t {
    if (info->type == H5O_TYPE_DATASET)
      static_cast<std::vector<std::string>*>(data)->push_back(name);
    return 0;
  };
  H5Ovisit(file_, H5_INDEX_NAME, H5_ITER_INC, visit, &names);
  std::sort(names.begin(), names.end());
  return names;
}

std::vector<std::int64_t> H5Reader::Dims(const std::string& name) const {
  const Handle dataset(H5Dopen2(file_, name.c_str(), H5P_DEFAULT), H5Dclose);
  if (dataset < 0) Fail("{}: dataset '{}' is missing", path_, name);
  const Handle space(H5Dget_space(dataset), H5Sclose);
  return Extents(space);
}

std::string H5Reader::TypeName(const std::string& name) const {
  const Handle dataset(H5Dopen2(file_, name.c_str(), H5P_DEFAULT), H5Dclose);
  if (dataset < 0) Fail("{}: dataset '{}' is missing", path_, name);
  const Handle type(H5Dget_type(dataset), H5Tclose);
  return TypeText(type);
}

std::string H5Reader::DatasetAttribute(const std::string& name,
                                       const std::string& attribute) const {
  const Handle dataset(H5Dopen2(file_, name.c_str(), H5P_DEFAULT), H5Dclose);
  if (dataset < 0) Fail("{}: dataset '{}' is missing", path_, name);
  return ReadAttribute(dataset, path_ + ": " + name, attribute);
}

#define DEX_INSTANTIATE(T)                                                                     \
  template void H5Writer::Write(const std::string&, const std::vector<T>&,                     \
                                const std::vector<std::int64_t>&, const H5Doc&);               \
  template H5Array<T> H5Reader::Read(const std::string&, const std::vector<std::int64_t>&) const;
DEX_INSTANTIATE(double)
DEX_INSTANTIATE(float)
DEX_INSTANTIATE(std::int32_t)
DEX_INSTANTIATE(std::int64_t)
DEX_INSTANTIATE(std::uint64_t)
DEX_INSTANTIATE(std::uint8_t)
#undef DEX_INSTANTIATE

}  // namespace dexremoe
