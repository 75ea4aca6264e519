#include <algorithm>
#include <filesystem>

#include "base/error.h"
#include "io/h5.h"
#include "io/h5_internal.h"

namespace dexremoe {
namespace {

using internal::Count;
using internal::Handle;
using internal::NativeType;

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
  for (const std::int64_t d : dims)
    text += (text.empty() ? "" : ", ") + (d < 0 ? "any" : fmt::format("{}", d));
  return "[" + text + "]";
}

std::string ReadAttribute(hid_t object, const std::string& path, const std::string& name) {
  if (H5Aexists(object, name.c_str()) <= 0)
    Fail("{}: attribute '{}' is missing; not a file of this project", path, name);
  const Handle attribute(H5Aopen(object, name.c_str(), H5P_DEFAULT), H5Aclose);
  const Handle type(H5Aget_type(attribute), H5Tclose);
  if (H5Tget_class(type) != H5T_STRING || H5Tis_variable_str(type) > 0)
    Fail("{}: attribute '{}': expected text of fixed length, found another type", path, name);
  std::string value(H5Tget_size(type), '\0');
  if (H5Aread(attribute, type, value.data()) < 0)
    Fail("{}: attribute '{}' is unreadable", path, name);
  value.resize(value.find_last_not_of('\0') + 1);
  return value;
}

std::vector<std::int64_t> Extents(hid_t space) {
  const int rank = H5Sget_simple_extent_ndims(space);
  std::vector<hsize_t> dims(std::max(rank, 0));
  if (rank > 0) H5Sget_simple_extent_dims(space, dims.data(), nullptr);
  return {dims.begin(), dims.end()};
}

}  // namespace

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
  internal::StartHdf5();
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
  if (!array.values.empty() &&
      H5Dread(dataset, NativeType<T>(), H5S_ALL, H5S_ALL, H5P_DEFAULT, array.values.data()) < 0)
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

#define DEX_INSTANTIATE(T) \
  template H5Array<T> H5Reader::Read(const std::string&, const std::vector<std::int64_t>&) const;
DEX_INSTANTIATE(double)
DEX_INSTANTIATE(float)
DEX_INSTANTIATE(std::int32_t)
DEX_INSTANTIATE(std::int64_t)
DEX_INSTANTIATE(std::uint64_t)
DEX_INSTANTIATE(std::uint8_t)
#undef DEX_INSTANTIATE

}  // namespace dexremoe
