#include "render/output/recording_sheet.h"

#include <zlib.h>

#include <cstdint>
#include <nlohmann/json.hpp>

#include "engine/core/error.h"
#include "engine/core/files.h"

namespace condyle {
namespace {

std::uint32_t big_endian(const std::string& bytes, std::size_t at) {
  std::uint32_t value = 0;
  for (std::size_t i = 0; i < 4; ++i)
    value = value << 8 | static_cast<unsigned char>(bytes[at + i]);
  return value;
}

}  // namespace

std::optional<RecordingSheet> read_recording_sheet(const std::filesystem::path& file) {
  try {
    const auto json = nlohmann::json::parse(read_file(file, 1 << 20));
    RecordingSheet sheet;
    for (const auto& [name, value] : json.items()) sheet[name] = value.get<std::string>();
    return sheet;
  } catch (const InputError&) {
    return std::nullopt;
  } catch (const nlohmann::json::exception&) {
    return std::nullopt;
  }
}

void write_recording_sheet(const std::filesystem::path& file, const RecordingSheet& sheet) {
  write_file(file, nlohmann::json(sheet).dump(2) + "\n");
}

std::vector<std::string> differing(const RecordingSheet& before, const RecordingSheet& now) {
  std::vector<std::string> names;
  for (const auto& [name, value] : now)
    if (const auto old = before.find(name); old == before.end() || old->second != value)
      names.push_back(name);
  for (const auto& [name, value] : before)
    if (!now.contains(name)) names.push_back(name);
  return names;
}

std::string difference(const RecordingSheet& before, const RecordingSheet& now) {
  const auto text_of = [](const RecordingSheet& sheet, const std::string& name) {
    const auto entry = sheet.find(name);
    return entry == sheet.end() ? std::string("not noted") : entry->second;
  };
  std::string text;
  for (const std::string& name : differing(before, now))
    text += (text.empty() ? "" : "; ") + name + " was " + text_of(before, name) + ", is " +
            text_of(now, name);
  return text;
}

bool is_whole_png(const std::filesystem::path& file, int width, int height) {
  std::string bytes;
  try {
    bytes = read_file(file, std::size_t{2} << 30);
  } catch (const InputError&) {
    return false;
  }
  if (bytes.compare(0, 8, "\x89PNG\r\n\x1a\n") != 0) return false;
  for (std::size_t at = 8; at + 12 <= bytes.size();) {
    const std::size_t size = big_endian(bytes, at);
    if (size > bytes.size() - at - 12) return false;
    const std::string kind = bytes.substr(at + 4, 4);
    const auto* checked = reinterpret_cast<const Bytef*>(bytes.data() + at + 4);
    if (crc32(0, checked, static_cast<uInt>(size + 4)) != big_endian(bytes, at + 8 + size))
      return false;
    if (at == 8 && (kind != "IHDR" || size != 13 ||
                    big_endian(bytes, at + 8) != static_cast<std::uint32_t>(width) ||
                    big_endian(bytes, at + 12) != static_cast<std::uint32_t>(height)))
      return false;
    if (kind == "IEND") return at + 12 == bytes.size();
    at += 12 + size;
  }
  return false;
}

}  // namespace condyle
