#include "engine/dicom/assemble_volume.h"

#include <fmt/format.h>

#include <Eigen/Geometry>
#include <algorithm>
#include <cmath>

#include "engine/core/parallel.h"
#include "engine/dicom/slice_pixels.h"

namespace condyle {
namespace {

constexpr std::size_t most_values = std::size_t{1} << 31;
constexpr std::uint64_t largest_ratio = 1032;  // of compression
constexpr double whole_pixel = 1e-3;           // shifts nearer to whole pixels are whole

/// The lattice within a plane that holds all shifted slices: its first pixel and its size.
struct PlaneFrame {
  int first_column = 0, first_row = 0, columns = 0, rows = 0;
};

/// A shift along an axis in pixels: whole pixels, and a fraction toward the next.
struct PixelShift {
  int whole = 0;
  double fraction = 0;
};

PixelShift pixel_shift(double pixels) {
  const double near = std::round(pixels);
  if (std::abs(pixels - near) < whole_pixel) return {static_cast<int>(near), 0};
  const double low = std::floor(pixels);
  return {static_cast<int>(low), pixels - low};
}

PlaneFrame plane_frame(const std::vector<SliceHeader>& slices, const StackGeometry& stack) {
  const SliceHeader& first = slices.front();
  PlaneFrame frame{0, 0, first.pixels.columns, first.pixels.rows};
  if (!stack.sheared) return frame;
  int last_column = 0, last_row = 0;
  for (const Eigen::Vector2d& shift : stack.shift_mm) {
    const PixelShift x = pixel_shift(shift.x() / first.column_spacing_mm),
                     y = pixel_shift(shift.y() / first.row_spacing_mm);
    frame.first_column = std::min(frame.first_column, x.whole);
    frame.first_row = std::min(frame.first_row, y.whole);
    last_column = std::max(last_column, x.whole + (x.fraction > 0));
    last_row = std::max(last_row, y.whole + (y.fraction > 0));
  }
  frame.columns += last_column - frame.first_column;
  frame.rows += last_row - frame.first_row;
  return frame;
}

/// Checks what will be requested of the memory.
void check_memory(const std::vector<SliceHeader>& slices, const PlaneFrame& frame) {
  const double values =
      static_cast<double>(frame.columns) * frame.rows * static_cast<double>(slices.size());
  if (values > static_cast<double>(most_values))
    throw DicomDamage(fmt::format("has {} slices of {} x {} values: more than 2147483648",
                                  slices.size(), frame.columns, frame.rows));
  std::uint64_t stated = 0, held = 0;
  for (const SliceHeader& slice : slices) {
    std::error_code error;
    const std::uintmax_t size = std::filesystem::file_size(slice.file, error);
    if (!error) held += size;
    stated += slice.pixels.bytes();
  }
  if (stated / largest_ratio > held)
    throw DicomDamage(fmt::format("states {} bytes of pixels in files of {} bytes", stated, held));
}

/// Linear interpolation between neighbours; outside the picture there is air.
void shift_slice(const std::vector<std::int16_t>& in, const SlicePixels& pixels, PixelShift x,
                 PixelShift y, const PlaneFrame& frame, std::int16_t* out) {
  const auto value = [&](int row, int column) -> double {
    if (row < 0 || row >= pixels.rows || column < 0 || column >= pixels.columns) return air_hu;
    return in[static_cast<std::size_t>(row) * static_cast<std::size_t>(pixels.columns) +
              static_cast<std::size_t>(column)];
  };
  // Rows and columns of the lattice against those of the picture.
  const int row_offset = frame.first_row - y.whole, column_offset = frame.first_column - x.whole;
  for (int row = 0; row < frame.rows; ++row)
    for (int column = 0; column < frame.columns; ++column) {
      const int r = row + row_offset, c = column + column_offset;
      double hu = value(r, c) * (1 - x.fraction) * (1 - y.fraction);
      if (x.fraction > 0) hu += value(r, c - 1) * x.fraction * (1 - y.fraction);
      if (y.fraction > 0) hu += value(r - 1, c) * (1 - x.fraction) * y.fraction;
      if (x.fraction > 0 && y.fraction > 0) hu += value(r - 1, c - 1) * x.fraction * y.fraction;
      *out++ = static_cast<std::int16_t>(std::round(hu));
    }
}

/// Slices at even heights, each between its two neighbours.
void resample_heights(Volume& volume, const StackGeometry& stack, int threads) {
  const std::size_t plane =
      static_cast<std::size_t>(volume.size[0]) * static_cast<std::size_t>(volume.size[1]);
  const double last = stack.height_mm.back();
  const auto count = static_cast<std::size_t>(std::floor(last / stack.step_mm + 1e-6)) + 1;
  if (static_cast<double>(count) * static_cast<double>(plane) > static_cast<double>(most_values))
    throw DicomDamage("has more values than are read when it is resampled");
  std::vector<std::int16_t> even(count * plane);
  parallel_for(count, threads, [&](std::size_t k) {
    const double height = std::min(static_cast<double>(k) * stack.step_mm, last);
    const auto above = static_cast<std::size_t>(
        std::lower_bound(stack.height_mm.begin() + 1, stack.height_mm.end() - 1, height) -
        stack.height_mm.begin());
    const double low = stack.height_mm[above - 1], high = stack.height_mm[above];
    const double fraction = std::clamp((height - low) / (high - low), 0.0, 1.0);
    const std::int16_t* below = volume.values.data() + (above - 1) * plane;
    for (std::size_t i = 0; i < plane; ++i)
      even[k * plane + i] = static_cast<std::int16_t>(
          std::round(below[i] * (1 - fraction) + below[plane + i] * fraction));
  });
  volume.values = std::move(even);
  volume.size[2] = static_cast<int>(count);
  volume.spacing_mm.z() = stack.step_mm;
}

/// What was wrong with a slice; empty for none.
std::string place_slice(const SliceHeader& slice, const Eigen::Vector2d& shift_mm,
                        const StackGeometry& stack, const PlaneFrame& frame, std::int16_t* out) {
  try {
    const std::vector<std::int16_t> values = read_slice(slice);
    if (stack.sheared)
      shift_slice(values, slice.pixels, pixel_shift(shift_mm.x() / slice.column_spacing_mm),
                  pixel_shift(shift_mm.y() / slice.row_spacing_mm), frame, out);
    else
      std::copy(values.begin(), values.end(), out);
  } catch (const DicomDamage& damage) {
    return fmt::format("file {} {}", slice.number, damage.what());
  }
  return "";
}

}  // namespace

Volume assemble_volume(const std::vector<SliceHeader>& slices, const StackGeometry& stack,
                       int threads, const Progress& progress) {
  constexpr std::size_t chunk = 16;
  const SliceHeader& first = slices.front();
  const PlaneFrame frame = plane_frame(slices, stack);
  check_memory(slices, frame);
  Volume volume;
  volume.size = {frame.columns, frame.rows, static_cast<int>(slices.size())};
  volume.spacing_mm = {first.column_spacing_mm, first.row_spacing_mm,
                       stack.height_mm.back() / static_cast<double>(slices.size() - 1)};
  volume.axes << first.along_row, first.along_column, stack.normal;
  volume.origin = *first.position +
                  first.along_row * (frame.first_column * first.column_spacing_mm) +
                  first.along_column * (frame.first_row * first.row_spacing_mm);
  const std::size_t plane =
      static_cast<std::size_t>(frame.columns) * static_cast<std::size_t>(frame.rows);
  volume.values.resize(plane * slices.size());
  std::vector<std::string> problems(slices.size());
  for (std::size_t begin = 0; begin < slices.size(); begin += chunk) {
    report(progress, "slices", static_cast<double>(begin) / static_cast<double>(slices.size()));
    const std::size_t count = std::min(chunk, slices.size() - begin);
    parallel_for(count, threads, [&](std::size_t i) {
      const std::size_t k = begin + i;
      problems[k] =
          place_slice(slices[k], stack.shift_mm[k], stack, frame, volume.values.data() + k * plane);
    });
    for (std::size_t k = begin; k < begin + count; ++k)
      if (!problems[k].empty()) throw DicomDamage(problems[k]);
  }
  if (!stack.uneven.empty()) resample_heights(volume, stack, threads);
  return volume;
}

}  // namespace condyle
