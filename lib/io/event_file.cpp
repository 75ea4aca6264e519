#include "io/event_file.h"

#include <spdlog/fmt/fmt.h>

#include <array>
#include <bit>
#include <cerrno>
#include <cmath>
#include <cstring>
#include <filesystem>
#include <optional>
#include <string_view>

#include "base/error.h"
#include "io/atomic_file.h"

namespace dexremoe {
namespace {

namespace fs = std::filesystem;

constexpr std::string_view kPrefix = "events.out.tfevents.", kSuffix = ".dexremoe";
constexpr std::size_t kHeader = 12, kFooter = 4;  // bytes around a record

constexpr std::array<std::uint32_t, 256> CrcTable() {
  std::array<std::uint32_t, 256> table{};
  for (std::uint32_t i = 0; i < 256; ++i) {
    table[i] = i;
    for (int bit = 0; bit < 8; ++bit)
      table[i] = (table[i] >> 1) ^ ((table[i] & 1) != 0 ? 0x82F63B78u : 0u);
  }
  return table;
}

// Record files store a checksum rotated and shifted, so that sums of sums stay apart.
std::uint32_t MaskedCrc(const std::string& bytes) {
  return std::rotr(Crc32c(bytes), 15) + 0xA282EAD8u;
}

template <typename Word>
std::string LittleEndian(Word word) {
  std::string bytes;
  for (std::size_t i = 0; i < sizeof word; ++i) bytes += static_cast<char>(word >> (8 * i));
  return bytes;
}

std::uint64_t LittleEndianAt(std::string_view bytes, std::size_t at, std::size_t size) {
  std::uint64_t word = 0;
  for (std::size_t i = size; i-- > 0;) word = word << 8 | static_cast<std::uint8_t>(bytes[at + i]);
  return word;
}

// Protobuf's wire format: keys are field << 3 | type, with type 0 varint, 1 eight bytes, 2 length
// and bytes, 5 four bytes.
std::string Varint(std::uint64_t value) {
  std::string bytes;
  for (; value >= 0x80; value >>= 7) bytes += static_cast<char>(value | 0x80);
  return bytes + static_cast<char>(value);
}

std::string BytesField(int field, const std::string& bytes) {
  return Varint(field << 3 | 2) + Varint(bytes.size()) + bytes;
}

std::string EventHead(double wall_time, std::int64_t step) {
  return Varint(1 << 3 | 1) + LittleEndian(std::bit_cast<std::uint64_t>(wall_time)) +
         Varint(2 << 3 | 0) + Varint(static_cast<std::uint64_t>(step));
}

// The step of an event that EventHead began.
std::int64_t StepOf(std::string_view event) {
  std::uint64_t step = 0;
  std::size_t at = 10;  // behind wall_time and the key
  for (int shift = 0; at < event.size() && shift < 64; shift += 7, ++at) {
    step |= static_cast<std::uint64_t>(event[at] & 0x7F) << shift;
    if ((event[at] & 0x80) == 0) break;
  }
  return static_cast<std::int64_t>(step);
}

// Length of the leading whole records whose steps are at most `step`.
std::size_t KeptLength(const std::string& bytes, std::int64_t step) {
  std::size_t end = 0;
  while (bytes.size() - end >= kHeader + kFooter) {
    const std::uint64_t length = LittleEndianAt(bytes, end, 8);
    if (length > bytes.size() - end - kHeader - kFooter) break;
    const std::string event = bytes.substr(end + kHeader, length);
    if (LittleEndianAt(bytes, end + kHeader + length, 4) != MaskedCrc(event)) break;
    if (StepOf(event) > step) break;
    end += kHeader + length + kFooter;
  }
  return end;
}

std::string NameOf(std::int64_t step) { return fmt::format("{}{:015}{}", kPrefix, step, kSuffix); }

// The step that one of our files follows; empty for other names.
std::optional<std::int64_t> FirstStep(const std::string& name) {
  if (!name.starts_with(kPrefix) || !name.ends_with(kSuffix)) return {};
  const std::string digits =
      name.substr(kPrefix.size(), name.size() - kPrefix.size() - kSuffix.size());
  if (digits.empty() || digits.find_first_not_of("0123456789") != std::string::npos) return {};
  return std::stoll(digits);
}

void CutAfter(const fs::path& folder, std::int64_t step) {
  std::vector<fs::path> files;
  for (const auto& entry : fs::directory_iterator(folder)) files.push_back(entry.path());
  for (const fs::path& file : files) {
    const auto first = FirstStep(file.filename());
    if (!first) continue;
    std::error_code code;
    if (*first >= step)
      fs::remove(file, code);
    else
      fs::resize_file(file, KeptLength(ReadFile(file), step), code);
    if (code) Fail("{}: cannot be cut: {}", file.string(), code.message());
  }
}

}  // namespace

std::uint32_t Crc32c(const std::string& bytes) {
  static constexpr std::array<std::uint32_t, 256> kTable = CrcTable();
  std::uint32_t crc = ~0u;
  for (const char byte : bytes)
    crc = (crc >> 8) ^ kTable[(crc ^ static_cast<std::uint8_t>(byte)) & 0xFF];
  return ~crc;
}

EventFile::EventFile(const std::string& folder, std::int64_t step)
    : path_(fs::path(folder) / NameOf(step)) {
  std::error_code code;
  fs::create_directories(folder, code);
  if (code) Fail("{}: cannot create the folder: {}", folder, code.message());
  CutAfter(folder, step);
  // Not written aside and renamed: it is a log that is read while it grows.
  file_ = std::fopen(path_.c_str(), "wb");
  if (file_ == nullptr) Fail("{}: cannot be created: {}", path_, std::strerror(errno));
  Append(EventHead(0, step) + BytesField(3, "brain.Event:2"));
}

EventFile::~EventFile() { std::fclose(file_); }

void EventFile::Add(std::int64_t step, double wall_time,
                    const std::vector<std::pair<std::string, double>>& scalars) {
  std::string summary;
  for (const auto& [tag, value] : scalars)
    if (std::isfinite(value))
      summary +=
          BytesField(1, BytesField(1, tag) + Varint(2 << 3 | 5) +
                            LittleEndian(std::bit_cast<std::uint32_t>(static_cast<float>(value))));
  Append(EventHead(wall_time, step) + BytesField(5, summary));
}

void EventFile::Append(const std::string& event) {
  const std::string length = LittleEndian(static_cast<std::uint64_t>(event.size()));
  const std::string record =
      length + LittleEndian(MaskedCrc(length)) + event + LittleEndian(MaskedCrc(event));
  if (std::fwrite(record.data(), 1, record.size(), file_) != record.size() ||
      std::fflush(file_) != 0)
    Fail("{}: cannot be written: {}", path_, std::strerror(errno));
}

}  // namespace dexremoe
