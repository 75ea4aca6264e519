// Event files of TensorBoard: scalars over steps, readable while they grow.
//
// The format is TensorFlow's (tensorflow/core/lib/io/record_writer.cc, core/util/event.proto,
// core/framework/summary.proto). A file is a row of records, little-endian:
//   u64 length | u32 masked CRC-32C of the length | bytes | u32 masked CRC-32C of the bytes
// and the bytes are a protobuf message
//   Event { double wall_time = 1; int64 step = 2; string file_version = 3; Summary summary = 5; }
//   Summary { repeated Value value = 1; }   Value { string tag = 1; float simple_value = 2; }
#pragma once

#include <cstdint>
#include <cstdio>
#include <string>
#include <utility>
#include <vector>

namespace dexremoe {

class EventFile {
 public:
  // Continues the record kept in `folder` (made if needed) after `step`: events beyond it, and
  // records that a kill left torn, are cut off the files there; a new file takes what follows, as
  // TensorBoard joins all files of a folder. Files of other programs are left alone. Throws Error
  // naming the file that cannot be changed.
  EventFile(const std::string& folder, std::int64_t step);
  ~EventFile();
  EventFile(const EventFile&) = delete;
  EventFile& operator=(const EventFile&) = delete;

  // One event: (tag, value) pairs at `step`, at wall_time in s since 1970. Values that are not
  // finite are left out. On disk when this returns; throws Error when it cannot be.
  void Add(std::int64_t step, double wall_time,
           const std::vector<std::pair<std::string, double>>& scalars);

 private:
  void Append(const std::string& event);
  std::string path_;
  std::FILE* file_;
};

// CRC-32C (Castagnoli; RFC 3720, B.4).
std::uint32_t Crc32c(const std::string& bytes);

}  // namespace dexremoe
