// A reader of event files for tests, independent of the writer: bitwise checksums and a protobuf
// walk that accepts fields in any order.
#pragma once

#include <cstdint>
#include <cstring>
#include <filesystem>
#include <fstream>
#include <map>
#include <sstream>
#include <stdexcept>
#include <string>
#include <vector>

namespace dexremoe {

struct ReadEvent {
  double wall_time = 0;
  std::int64_t step = 0;
  std::string file_version;
  std::map<std::string, float> scalars;
};

class EventReader {
 public:
  // All events of a folder, its files in the order of their names, as TensorBoard reads them.
  static std::vector<ReadEvent> ReadFolder(const std::string& folder) {
    std::map<std::string, std::filesystem::path> files;
    for (const auto& entry : std::filesystem::directory_iterator(folder))
      files[entry.path().filename()] = entry.path();
    std::vector<ReadEvent> events;
    for (const auto& [name, path] : files) {
      const std::vector<ReadEvent> more = Read(path);
      events.insert(events.end(), more.begin(), more.end());
    }
    return events;
  }

  // Throws std::runtime_error for a checksum that is wrong or a record that is torn.
  static std::vector<ReadEvent> Read(const std::string& path) {
    std::stringstream text;
    text << std::ifstream(path, std::ios::binary).rdbuf();
    const std::string bytes = text.str();
    std::vector<ReadEvent> events;
    for (std::size_t at = 0; at < bytes.size();) {
      const auto length = Word<std::uint64_t>(bytes, at);
      Require(Word<std::uint32_t>(bytes, at + 8) == Masked(bytes.substr(at, 8)), "length");
      const std::string record = bytes.substr(at + 12, length);
      Require(Word<std::uint32_t>(bytes, at + 12 + length) == Masked(record), "record");
      events.push_back(ParseEvent(record));
      at += 12 + length + 4;
    }
    return events;
  }

 private:
  static void Require(bool condition, const char* what) {
    if (!condition) throw std::runtime_error(std::string("event file: bad ") + what);
  }

  template <typename T>
  static T Word(const std::string& bytes, std::size_t at) {
    Require(at + sizeof(T) <= bytes.size(), "end");
    T word;
    std::memcpy(&word, bytes.data() + at, sizeof word);
    return word;
  }

  static std::uint32_t Masked(const std::string& bytes) {
    std::uint32_t crc = 0xFFFFFFFF;
    for (const char byte : bytes)
      for (int bit = 0; bit < 8; ++bit) {
        const bool one = ((crc ^ (static_cast<std::uint8_t>(byte) >> bit)) & 1) != 0;
        crc = crc >> 1 ^ (one ? 0x82F63B78 : 0);
      }
    crc = ~crc;
    return (crc >> 15 | crc << 17) + 0xA282EAD8;
  }

  // The fields of a message: numbers as their bits, the rest as bytes.
  struct Field {
    int number;
    std::uint64_t bits;
    std::string bytes;
  };
  static std::uint64_t Varint(const std::string& bytes, std::size_t& at) {
    std::uint64_t value = 0;
    for (int shift = 0;; shift += 7) {
      const auto byte = Word<std::uint8_t>(bytes, at++);
      value |= static_cast<std::uint64_t>(byte & 0x7F) << shift;
      if (byte < 0x80) return value;
    }
  }
  static std::vector<Field> Fields(const std::string& bytes) {
    std::vector<Field> fields;
    for (std::size_t at = 0; at < bytes.size();) {
      const std::uint64_t key = Varint(bytes, at);
      Field field{static_cast<int>(key >> 3), 0, ""};
      if ((key & 7) == 0) {
        field.bits = Varint(bytes, at);
      } else if ((key & 7) == 1) {
        field.bits = Word<std::uint64_t>(bytes, at);
        at += 8;
      } else if ((key & 7) == 5) {
        field.bits = Word<std::uint32_t>(bytes, at);
        at += 4;
      } else {
        Require((key & 7) == 2, "wire type");
        const std::uint64_t length = Varint(bytes, at);
        Require(length <= bytes.size() - at, "field length");
        field.bytes = bytes.substr(at, length);
        at += length;
      }
      fields.push_back(field);
    }
    return fields;
  }

  template <typename To, typename Bits>
  static To Reinterpret(Bits bits) {
    To to;
    static_assert(sizeof to == sizeof bits);
    std::memcpy(&to, &bits, sizeof to);
    return to;
  }

  static ReadEvent ParseEvent(const std::string& record) {
    ReadEvent event;
    for (const Field& field : Fields(record)) {
      if (field.number == 1) event.wall_time = Reinterpret<double>(field.bits);
      if (field.number == 2) event.step = static_cast<std::int64_t>(field.bits);
      if (field.number == 3) event.file_version = field.bytes;
      if (field.number != 5) continue;
      for (const Field& value : Fields(field.bytes)) {
        std::string tag;
        float number = 0;
        for (const Field& part : Fields(value.bytes)) {
          if (part.number == 1) tag = part.bytes;
          if (part.number == 2) number = Reinterpret<float>(static_cast<std::uint32_t>(part.bits));
        }
        event.scalars[tag] = number;
      }
    }
    return event;
  }
};

}  // namespace dexremoe
