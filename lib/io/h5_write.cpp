#include <algorithm>
#include <filesystem>

#include "base/check.h"
#include "base/error.h"
#include "base/version.h"
#include "io/atomic_file.h"
#include "io/h5.h"
#include "io/h5_internal.h"
#include "io/hash.h"

namespace dexremoe {
namespace {

using internal::Count;
using internal::Handle;
using internal::NativeType;

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

std::string HashLine(const std::string& path) {
  return fmt::format("{} {}\n", std::filesystem::path(path).filename().string(),
                     HashOf(ReadFile(path)));
}

hid_t CreateDataset(hid_t file, const std::string& name, hid_t type,
                    const std::vector<std::int64_t>& dims) {
  const std::vector<hsize_t> extents(dims.begin(), dims.end());
  const Handle space(dims.empty()
                         ? H5Screate(H5S_SCALAR)
                         : H5Screate_simple(static_cast<int>(dims.size()), extents.data(), nullptr),
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
  internal::StartHdf5();
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
  const Handle dataset(CreateDataset(file_, name, type, {static_cast<std::int64_t>(values.size())}),
                       H5Dclose);
  if (dataset < 0) Fail("{}: dataset '{}' cannot be created", path_, name);
  if (!values.empty() && H5Dwrite(dataset, type, H5S_ALL, H5S_ALL, H5P_DEFAULT, packed.data()) < 0)
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

#define DEX_INSTANTIATE(T)                                                 \
  template void H5Writer::Write(const std::string&, const std::vector<T>&, \
                                const std::vector<std::int64_t>&, const H5Doc&);
DEX_INSTANTIATE(double)
DEX_INSTANTIATE(float)
DEX_INSTANTIATE(std::int32_t)
DEX_INSTANTIATE(std::int64_t)
DEX_INSTANTIATE(std::uint64_t)
DEX_INSTANTIATE(std::uint8_t)
#undef DEX_INSTANTIATE

}  // namespace dexremoe
