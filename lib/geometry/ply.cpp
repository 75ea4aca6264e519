#include "geometry/ply.h"

#include <algorithm>
#include <cctype>
#include <charconv>
#include <cmath>
#include <cstdint>
#include <cstring>
#include <map>
#include <sstream>
#include <vector>

#include "base/error.h"

namespace dexremoe {
namespace {

enum class Type { kInt8, kUint8, kInt16, kUint16, kInt32, kUint32, kFloat, kDouble };
enum class Format { kText, kLittle, kBig };

struct Property {
  std::string name;
  Type type = Type::kFloat;
  bool list = false;
  Type count_type = Type::kUint8;
};

struct Element {
  std::string name;
  std::size_t count = 0;
  std::vector<Property> properties;
};

struct Header {
  Format format = Format::kText;
  std::vector<Element> elements;
  std::size_t size = 0;  // bytes up to the first value
};

Type TypeNamed(const std::string& path, const std::string& name) {
  static const std::map<std::string, Type> kTypes = {
      {"char", Type::kInt8},     {"int8", Type::kInt8},     {"uchar", Type::kUint8},
      {"uint8", Type::kUint8},   {"short", Type::kInt16},   {"int16", Type::kInt16},
      {"ushort", Type::kUint16}, {"uint16", Type::kUint16}, {"int", Type::kInt32},
      {"int32", Type::kInt32},   {"uint", Type::kUint32},   {"uint32", Type::kUint32},
      {"float", Type::kFloat},   {"float32", Type::kFloat}, {"double", Type::kDouble},
      {"float64", Type::kDouble}};
  const auto found = kTypes.find(name);
  if (found == kTypes.end())
    Fail("{}: header: expected a number type (float, int, uchar, ...), found '{}'", path, name);
  return found->second;
}

void ReadHeaderLine(const std::string& path, std::istringstream& words, Header& header) {
  std::string word, name, type;
  words >> word;
  if (word == "format") {
    words >> name;
    if (name == "ascii")
      header.format = Format::kText;
    else if (name == "binary_little_endian")
      header.format = Format::kLittle;
    else if (name == "binary_big_endian")
      header.format = Format::kBig;
    else
      Fail("{}: format: expected ascii or binary_little_endian or binary_big_endian, found '{}'",
           path, name);
  } else if (word == "element") {
    Element element;
    if (!(words >> element.name >> element.count))
      Fail("{}: header: expected 'element NAME COUNT'", path);
    header.elements.push_back(element);
  } else if (word == "property") {
    if (header.elements.empty()) Fail("{}: header: expected an element before properties", path);
    Property property;
    words >> type;
    if (type == "list") {
      property.list = true;
      words >> type;
      property.count_type = TypeNamed(path, type);
      words >> type;
    }
    property.type = TypeNamed(path, type);
    words >> property.name;
    header.elements.back().properties.push_back(property);
  }
}

Header ReadHeader(const std::string& path, const std::string& bytes) {
  Header header;
  std::size_t at = 0;
  for (int line = 0;; ++line) {
    const std::size_t end = bytes.find('\n', at);
    if (end == std::string::npos)
      Fail("{}: not a readable mesh: expected a PLY header up to 'end_header'", path);
    std::string text = bytes.substr(at, end - at);
    if (!text.empty() && text.back() == '\r') text.pop_back();
    at = end + 1;
    if (line == 0 && text != "ply")
      Fail("{}: not a readable mesh: expected a first line 'ply'", path);
    if (text == "end_header") break;
    std::istringstream words(text);
    ReadHeaderLine(path, words, header);
  }
  header.size = at;
  return header;
}

// Hands out one value after the other.
class Values {
 public:
  Values(const std::string& path, const std::string& bytes, const Header& header)
      : path_(path),
        format_(header.format),
        at_(bytes.data() + header.size),
        end_(bytes.data() + bytes.size()) {}

  double Next(Type type) {
    if (format_ == Format::kText) return NextWord();
    switch (type) {
      case Type::kInt8:
        return Raw<std::int8_t>();
      case Type::kUint8:
        return Raw<std::uint8_t>();
      case Type::kInt16:
        return Raw<std::int16_t>();
      case Type::kUint16:
        return Raw<std::uint16_t>();
      case Type::kInt32:
        return Raw<std::int32_t>();
      case Type::kUint32:
        return Raw<std::uint32_t>();
      case Type::kFloat:
        return Raw<float>();
      case Type::kDouble:
        return Raw<double>();
    }
    return NAN;
  }
  // The length of a list. No more than the bytes left: a damaged file would take forever.
  int NextCount(Type type) {
    const double count = Next(type);
    if (!(count >= 0))
      Fail("{}: row {} of '{}': expected the length of a list, found {}", path_, row_,
           element_->name, count);
    if (count > static_cast<double>(end_ - at_)) Truncated();
    return static_cast<int>(count);
  }
  // Where the reading stands, for messages.
  void SetPlace(const Element& element, std::size_t row) {
    element_ = &element;
    row_ = row;
  }

 private:
  [[noreturn]] void Truncated() const {
    Fail("{}: file is truncated: expected {} rows of '{}', found {}", path_, element_->count,
         element_->name, row_);
  }
  template <typename T>
  T Raw() {
    if (end_ - at_ < static_cast<std::ptrdiff_t>(sizeof(T))) Truncated();
    char raw[sizeof(T)];
    std::memcpy(raw, at_, sizeof(T));
    at_ += sizeof(T);
    if (format_ == Format::kBig) std::reverse(raw, raw + sizeof(T));
    T value;
    std::memcpy(&value, raw, sizeof(T));
    return value;
  }
  double NextWord() {
    while (at_ < end_ && std::isspace(static_cast<unsigned char>(*at_)) != 0) ++at_;
    if (at_ == end_) Truncated();
    double value = 0;
    const auto [next, error] = std::from_chars(at_, end_, value);
    if (error != std::errc())
      Fail("{}: row {} of '{}': expected a number, found '{}'", path_, row_, element_->name,
           std::string(at_, std::find_if(at_, std::min(end_, at_ + 12),
                                         [](unsigned char c) { return std::isspace(c) != 0; })));
    at_ = next;
    return value;
  }

  const std::string& path_;
  Format format_;
  const char* at_;
  const char* end_;
  const Element* element_ = nullptr;
  std::size_t row_ = 0;
};

void ReadVertex(const Element& element, Values& values, TriMesh& mesh) {
  Eigen::Vector3d p = Eigen::Vector3d::Constant(NAN);
  for (const Property& property : element.properties) {
    const int repeats = property.list ? values.NextCount(property.count_type) : 1;
    for (int i = 0; i < repeats; ++i) {
      const double value = values.Next(property.type);
      if (!property.list && property.name.size() == 1 && property.name[0] >= 'x' &&
          property.name[0] <= 'z')
        p[property.name[0] - 'x'] = value;
    }
  }
  mesh.vertices.push_back(p);
}

void ReadFace(const Element& element, Values& values, TriMesh& mesh) {
  for (const Property& property : element.properties) {
    const int count = property.list ? values.NextCount(property.count_type) : 1;
    const bool corners =
        property.list && (property.name == "vertex_indices" || property.name == "vertex_index");
    std::array<int, 3> fan{};
    for (int i = 0; i < count; ++i) {
      // Out of range for an int only where it is out of range for the mesh.
      const double value = values.Next(property.type);
      const int index = value >= 0 ? static_cast<int>(std::min(value, 2147483647.0)) : -1;
      if (!corners) continue;
      if (i < 2) {
        fan[i] = index;
        continue;
      }
      fan[2] = index;
      mesh.triangles.push_back(fan);
      fan[1] = index;
    }
  }
}

void CheckMesh(const std::string& path, const TriMesh& mesh) {
  if (mesh.triangles.empty()) Fail("{}: expected at least one face, found none", path);
  for (std::size_t i = 0; i < mesh.vertices.size(); ++i)
    if (!mesh.vertices[i].allFinite())
      Fail("{}: vertex {}: expected finite coordinates, found ({}, {}, {})", path, i,
           mesh.vertices[i].x(), mesh.vertices[i].y(), mesh.vertices[i].z());
  const int count = static_cast<int>(mesh.vertices.size());
  for (const auto& triangle : mesh.triangles)
    for (const int index : triangle)
      if (index < 0 || index >= count)
        Fail("{}: faces: expected vertex indices in 0..{}, found {}", path, count - 1, index);
}

}  // namespace

TriMesh ParsePly(const std::string& path, const std::string& bytes) {
  const Header header = ReadHeader(path, bytes);
  Values values(path, bytes, header);
  TriMesh mesh;
  for (const Element& element : header.elements) {
    if (element.count > bytes.size())  // a row takes a byte or more
      Fail("{}: file is truncated: expected {} rows of '{}' in {} bytes", path, element.count,
           element.name, bytes.size());
    for (std::size_t row = 0; row < element.count; ++row) {
      values.SetPlace(element, row);
      if (element.name == "face") {
        ReadFace(element, values, mesh);
      } else if (element.name == "vertex") {
        ReadVertex(element, values, mesh);
      } else {
        TriMesh skipped;
        ReadVertex(element, values, skipped);
      }
    }
  }
  CheckMesh(path, mesh);
  return mesh;
}

}  // namespace dexremoe
