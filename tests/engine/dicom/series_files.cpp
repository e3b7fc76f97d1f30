#include "tests/engine/dicom/series_files.h"

#include <gtest/gtest.h>

#include <cmath>

#include "engine/core/error.h"
#include "engine/core/files.h"
#include "engine/dicom/dicom_elements.h"

namespace condyle::test {
namespace {

constexpr std::size_t first_of_meta = 132;

struct Place {
  std::size_t begin = 0, value = 0, end = 0;
  std::uint32_t tag = 0;
};

std::uint32_t number_at(const std::string& file, std::size_t at, std::size_t count) {
  return dicom_number(std::string_view(file).substr(at, count), false);
}

Place place_at(const std::string& file, std::size_t at) {
  Place place{at, 0, 0, number_at(file, at, 2) << 16 | number_at(file, at + 2, 2)};
  const std::string type = file.substr(at + 4, 2);
  const bool is_long = type == "OB" || type == "OW";
  place.value = at + (is_long ? 12 : 8);
  place.end = place.value + (is_long ? number_at(file, at + 8, 4) : number_at(file, at + 6, 2));
  return place;
}

/// The element, or the place where it belongs.
Place place_of(const std::string& file, std::uint32_t tag) {
  std::size_t at = first_of_meta;
  while (at < file.size()) {
    const Place place = place_at(file, at);
    if (place.tag >= tag) return place.tag == tag ? place : Place{at, at, at, place.tag};
    at = place.end;
  }
  return {at, at, at, 0};
}

}  // namespace

double small_volume_hu(const Eigen::Vector3d& position) {
  return 20 * position.x() - 15 * position.y() + 12 * position.z() - 300;
}

Volume small_volume() {
  Volume volume;
  volume.size = {24, 20, 9};
  volume.spacing_mm = {0.5, 0.6, 1.5};
  volume.origin = {-6, -31.5, 12.25};
  volume.values.resize(24 * 20 * 9);
  for (int k = 0; k < 9; ++k)
    for (int j = 0; j < 20; ++j)
      for (int i = 0; i < 24; ++i)
        volume.values[volume.index(i, j, k)] =
            static_cast<std::int16_t>(std::round(small_volume_hu(volume.position(i, j, k))));
  return volume;
}

void set_element(std::string& file, std::uint32_t tag, std::string value, const char* type) {
  if (value.size() % 2 != 0) value += std::string_view(type) == "UI" ? '\0' : ' ';
  const Place place = place_of(file, tag);
  std::string bytes;
  for (const std::uint32_t number : {tag >> 16, tag & 0xffff})
    bytes += {static_cast<char>(number), static_cast<char>(number >> 8)};
  bytes += type;
  bytes += {static_cast<char>(value.size()), static_cast<char>(value.size() >> 8)};
  bytes += value;
  file.replace(place.begin, place.end - place.begin, bytes);
}

void remove_element(std::string& file, std::uint32_t tag) {
  const Place place = place_of(file, tag);
  ASSERT_LT(place.begin, place.end);
  file.erase(place.begin, place.end - place.begin);
}

std::string element(const std::string& file, std::uint32_t tag) {
  const Place place = place_of(file, tag);
  std::string value = file.substr(place.value, place.end - place.value);
  while (!value.empty() && (value.back() == ' ' || value.back() == '\0')) value.pop_back();
  return value;
}

SeriesFiles::SeriesFiles(const Volume& volume, const CtWriteOptions& options) {
  const std::filesystem::path written = folder_.path() / "written";
  write_ct_series(volume, written, options);
  for (int k = 1; k <= volume.size[2]; ++k) {
    std::string name = std::to_string(k);
    name.insert(0, 4 - name.size(), '0');
    files_.push_back(read_file(written / ("slice-" + name + ".dcm")));
  }
  std::filesystem::create_directory(path());
}

void SeriesFiles::each(const std::function<void(std::string&)>& change) {
  for (std::string& file : files_) change(file);
}

void SeriesFiles::save(const std::string& prefix) {
  for (std::size_t i = 0; i < files_.size(); ++i)
    write_file(path() / (prefix + std::to_string(100 + i)), files_[i]);
}

void SeriesFiles::add(const std::string& name, const std::string& content) {
  write_file(path() / name, content);
}

std::string refusal(const CtFolder& folder, const CtRequest& request) {
  try {
    folder.read(request);
  } catch (const InputError& error) {
    return error.what();
  }
  ADD_FAILURE() << "the series is read";
  return "";
}

}  // namespace condyle::test
