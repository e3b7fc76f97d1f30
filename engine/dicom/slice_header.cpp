#include "engine/dicom/slice_header.h"

#include <fmt/format.h>

#include <Eigen/Geometry>
#include <charconv>
#include <cmath>

#include "engine/core/hash.h"
#include "engine/dicom/shown_facts.h"

// source: DICOM PS3.3, sections C.7.6.2 (image plane), C.7.6.3 (pixels) and C.8.2.1 (CT image)

namespace condyle {
namespace {

constexpr std::uint32_t
    image_type_tag = dicom_tag(0x0008, 0x0008),
    instance_tag = dicom_tag(0x0008, 0x0018), modality_tag = dicom_tag(0x0008, 0x0060),
    manufacturer_tag = dicom_tag(0x0008, 0x0070), patient_tag = dicom_tag(0x0010, 0x0020),
    thickness_tag = dicom_tag(0x0018, 0x0050), kvp_tag = dicom_tag(0x0018, 0x0060),
    kernel_tag = dicom_tag(0x0018, 0x1210), study_tag = dicom_tag(0x0020, 0x000d),
    series_tag = dicom_tag(0x0020, 0x000e), series_number_tag = dicom_tag(0x0020, 0x0011),
    acquisition_tag = dicom_tag(0x0020, 0x0012), position_tag = dicom_tag(0x0020, 0x0032),
    orientation_tag = dicom_tag(0x0020, 0x0037), frame_tag = dicom_tag(0x0020, 0x0052),
    samples_tag = dicom_tag(0x0028, 0x0002), frames_tag = dicom_tag(0x0028, 0x0008),
    rows_tag = dicom_tag(0x0028, 0x0010), columns_tag = dicom_tag(0x0028, 0x0011),
    spacing_tag = dicom_tag(0x0028, 0x0030), allocated_tag = dicom_tag(0x0028, 0x0100),
    stored_tag = dicom_tag(0x0028, 0x0101), high_bit_tag = dicom_tag(0x0028, 0x0102),
    sign_tag = dicom_tag(0x0028, 0x0103), padding_tag = dicom_tag(0x0028, 0x0120),
    intercept_tag = dicom_tag(0x0028, 0x1052), slope_tag = dicom_tag(0x0028, 0x1053);

const std::vector<std::uint32_t> read_tags = {
    image_type_tag, instance_tag,      modality_tag,    manufacturer_tag, patient_tag,
    thickness_tag,  kvp_tag,           kernel_tag,      study_tag,        series_tag,
    frame_tag,      series_number_tag, acquisition_tag, position_tag,     orientation_tag,
    samples_tag,    frames_tag,        rows_tag,        columns_tag,      spacing_tag,
    allocated_tag,  stored_tag,        high_bit_tag,    sign_tag,         padding_tag,
    intercept_tag,  slope_tag};

constexpr double least_pixel_mm = 1e-3, most_pixel_mm = 100, farthest_mm = 1e6;
constexpr double most_skew = 1e-3;  // cosine between the directions of rows and columns
constexpr std::uint64_t largest_slice = std::uint64_t{1} << 28;  // bytes

class HeaderValues {
 public:
  HeaderValues(const DicomValues& values, bool big_endian)
      : values_(values), big_endian_(big_endian) {}

  bool has(std::uint32_t tag) const { return values_.contains(tag); }
  std::string_view text(std::uint32_t tag) const {
    const auto found = values_.find(tag);
    if (found == values_.end()) return {};
    return without_blanks(found->second);
  }
  std::uint64_t hash(std::uint32_t tag) const {
    const std::string_view bytes = text(tag);
    return hash_bytes(bytes.data(), bytes.size());
  }
  /// Of two bytes; 0 where it is absent.
  int whole(std::uint32_t tag) const {
    const auto found = values_.find(tag);
    if (found == values_.end() || found->second.size() < 2) return 0;
    return static_cast<int>(
        dicom_number(std::string_view(found->second).substr(0, 2), big_endian_));
  }
  /// The numbers of a text; empty unless there are `count`, all finite.
  std::vector<double> decimals(std::uint32_t tag, std::size_t count) const {
    std::vector<double> numbers;
    for (std::string_view rest = text(tag); !rest.empty();) {
      const std::size_t end = std::min(rest.find('\\'), rest.size());
      std::string_view word = without_blanks(rest.substr(0, end));
      if (word.starts_with('+')) word.remove_prefix(1);
      double number = 0;
      const auto result = std::from_chars(word.data(), word.data() + word.size(), number);
      if (result.ec != std::errc() || result.ptr != word.data() + word.size() ||
          !std::isfinite(number))
        return {};
      numbers.push_back(number);
      rest.remove_prefix(std::min(end + 1, rest.size()));
    }
    return numbers.size() == count ? numbers : std::vector<double>();
  }
  std::optional<double> decimal(std::uint32_t tag) const {
    const std::vector<double> numbers = decimals(tag, 1);
    return numbers.empty() ? std::nullopt : std::optional(numbers[0]);
  }

 private:
  static std::string_view without_blanks(std::string_view text) {
    const auto blank = [](char c) { return c == ' ' || c == '\0'; };
    while (!text.empty() && blank(text.front())) text.remove_prefix(1);
    while (!text.empty() && blank(text.back())) text.remove_suffix(1);
    return text;
  }
  const DicomValues& values_;
  bool big_endian_;
};

/// The value of a pixel with this stored bit pattern.
int pixel_value(int bits, const SlicePixels& pixels) {
  const int unused = 32 - pixels.bits_stored;
  const auto shifted = static_cast<std::uint32_t>(bits) << unused;
  return pixels.is_signed ? static_cast<std::int32_t>(shifted) >> unused
                          : static_cast<int>(shifted >> unused);
}

std::string read_rescale(const HeaderValues& values, SlicePixels& pixels) {
  const auto slope = values.decimal(slope_tag), intercept = values.decimal(intercept_tag);
  if (!slope || !intercept)
    return "states no rescale slope and intercept: its values are not Hounsfield units";
  if (*slope == 0) return "states the rescale slope 0";
  pixels.slope = *slope;
  pixels.intercept = *intercept;
  if (values.has(padding_tag))
    pixels.padding_hu = *slope * pixel_value(values.whole(padding_tag), pixels) + *intercept;
  return "";
}

/// What is wrong with the stated layout of the pixels.
std::string read_layout(const HeaderValues& values, SlicePixels& pixels) {
  pixels.rows = values.whole(rows_tag);
  pixels.columns = values.whole(columns_tag);
  pixels.samples = values.has(samples_tag) ? values.whole(samples_tag) : 1;
  pixels.bits_allocated = values.whole(allocated_tag);
  pixels.bits_stored = values.whole(stored_tag);
  pixels.high_bit = values.whole(high_bit_tag);
  pixels.is_signed = values.whole(sign_tag) != 0;
  if (const auto frames = values.decimal(frames_tag); frames && *frames > 1 && *frames < 1e6)
    pixels.frames = static_cast<int>(*frames);
  if (pixels.rows == 0 || pixels.columns == 0) return "states no number of rows and columns";
  if (pixels.samples != 1) return "is a colour picture";
  if (pixels.frames != 1) return fmt::format("holds {} frames, where one is read", pixels.frames);
  if ((pixels.bits_allocated != 8 && pixels.bits_allocated != 16) || pixels.bits_stored < 1 ||
      pixels.bits_stored > pixels.bits_allocated || pixels.high_bit >= pixels.bits_allocated ||
      pixels.high_bit < pixels.bits_stored - 1)
    return fmt::format("states {} of {} bits a pixel up to bit {}, which is not read",
                       pixels.bits_stored, pixels.bits_allocated, pixels.high_bit);
  return "";
}

/// Compares the stated size of the picture with what the file holds, before memory is requested.
std::string check_pixels(DicomBytes& bytes, const DicomElements& elements, SlicePixels& pixels) {
  if (!elements.syntax->readable)
    return fmt::format("is compressed as {}, which is not supported", elements.syntax->name);
  if (!elements.pixels) return "holds no pixels";
  pixels.location = *elements.pixels;
  const std::uint64_t stated = pixels.bytes();
  const std::string size = fmt::format("{} x {} pixels", pixels.columns, pixels.rows);
  if (elements.syntax->compressed != pixels.location.fragments)
    return "holds pixels in another form than it states";
  if (pixels.location.fragments) {
    if (stated > largest_slice) return fmt::format("states {}, more than are read", size);
    try {
      if (pixel_fragments(bytes, pixels.location.begin).empty()) return "holds no pixels";
    } catch (const DicomDamage& damage) {
      return damage.what();
    }
    return "";
  }
  const std::uint64_t held = std::min(bytes.size() - pixels.location.begin, pixels.location.length);
  if (held < stated) return fmt::format("states {}, {} bytes, and holds {}", size, stated, held);
  // A byte may follow that makes the length even.
  if (pixels.location.length > stated + 1)
    return fmt::format("states {}, {} bytes, and that it holds {}", size, stated,
                       pixels.location.length);
  if (stated > largest_slice) return fmt::format("states {}, more than are read", size);
  return "";
}

std::string read_spacing(const HeaderValues& values, SliceHeader& slice) {
  const auto spacing = values.decimals(spacing_tag, 2);
  if (spacing.empty()) return "states no pixel spacing";
  for (const double mm : spacing)
    if (!(mm >= least_pixel_mm && mm <= most_pixel_mm))
      return fmt::format("states the pixel spacing {:g} x {:g} mm", spacing[0], spacing[1]);
  slice.row_spacing_mm = spacing[0];
  slice.column_spacing_mm = spacing[1];
  return "";
}

std::string read_plane(const HeaderValues& values, SliceHeader& slice) {
  std::string problem;
  if (const auto at = values.decimals(position_tag, 3); at.empty()) {
    problem = "states no position";
  } else {
    slice.position = Eigen::Vector3d(at[0], at[1], at[2]);
    if (slice.position->cwiseAbs().maxCoeff() > farthest_mm) problem = "states a position too far";
  }
  const auto cosines = values.decimals(orientation_tag, 6);
  if (cosines.empty()) return problem.empty() ? "states no orientation" : problem;
  const Eigen::Vector3d row(cosines[0], cosines[1], cosines[2]),
      column(cosines[3], cosines[4], cosines[5]);
  if (std::abs(row.norm() - 1) > 0.01 || std::abs(column.norm() - 1) > 0.01)
    return "states directions of rows and columns that are not unit vectors";
  if (std::abs(row.dot(column)) > most_skew)
    return "states directions of rows and columns that are not perpendicular";
  slice.along_row = row.normalized();
  slice.along_column = (column - slice.along_row * slice.along_row.dot(column)).normalized();
  return problem;
}

/// A scout: the third value of the image's type is LOCALIZER.
bool is_localizer(std::string_view image_type) {
  return image_type.find("LOCALIZER") != std::string_view::npos;
}

void read_facts(const HeaderValues& values, SliceHeader& slice) {
  slice.patient = values.hash(patient_tag);
  slice.study = values.hash(study_tag);
  slice.series = values.hash(series_tag);
  slice.frame_of_reference = values.hash(frame_tag);
  slice.instance = values.hash(instance_tag);
  slice.image_type = values.hash(image_type_tag);
  slice.acquisition = values.hash(acquisition_tag);
  slice.is_scout = is_localizer(values.text(image_type_tag));
  slice.is_ct = values.text(modality_tag) == "CT";
  slice.modality = shown_modality(values.text(modality_tag));
  slice.kernel = shown_kernel(values.text(kernel_tag));
  slice.kernel_text = values.hash(kernel_tag);
  slice.manufacturer = shown_manufacturer(values.text(manufacturer_tag));
  slice.kvp = values.decimal(kvp_tag).value_or(0);
  slice.thickness_mm = values.decimal(thickness_tag).value_or(0);
  if (const auto number = values.decimal(series_number_tag); number && std::abs(*number) < 1e9)
    slice.series_number = static_cast<int>(*number);
}

}  // namespace

FileHeader read_file_header(const std::filesystem::path& file) {
  FileHeader header;
  SliceHeader& slice = header.slice;
  slice.file = file;
  try {
    auto bytes = open_dicom(file);
    if (!bytes) {
      header.kind = DicomBytes(file).size() == 0 ? DicomFileKind::empty : DicomFileKind::not_dicom;
      return header;
    }
    const DicomElements elements = read_elements(*bytes, read_tags);
    const HeaderValues values(elements.values, elements.syntax && elements.syntax->big_endian);
    const bool of_a_series = values.has(series_tag);
    if (!elements.damage.empty() && !of_a_series) {
      header.kind = DicomFileKind::damaged;
      return header;
    }
    const bool an_image = elements.pixels || values.has(rows_tag);
    header.kind =
        !an_image && elements.damage.empty() ? DicomFileKind::without_image : DicomFileKind::slice;
    read_facts(values, slice);
    slice.pixels.syntax = elements.syntax;
    // All are tried, so that what is right is known; the first problem is reported.
    const auto note = [&](const std::string& problem) {
      if (slice.problem.empty()) slice.problem = problem;
    };
    note(elements.damage);
    if (!elements.known_syntax) note("has an unknown transfer syntax");
    note(read_layout(values, slice.pixels));
    if (slice.problem.empty()) note(check_pixels(*bytes, elements, slice.pixels));
    note(read_plane(values, slice));
    note(read_spacing(values, slice));
    note(read_rescale(values, slice.pixels));
  } catch (const DicomDamage&) {
    header.kind = DicomFileKind::damaged;
  }
  return header;
}

}  // namespace condyle
