#pragma once

#include <Eigen/Core>
#include <cstdint>
#include <filesystem>
#include <optional>
#include <string>

#include "engine/dicom/dicom_elements.h"

namespace condyle {

/// How the pixels of a slice are stored.
struct SlicePixels {
  const TransferSyntax* syntax = nullptr;
  PixelLocation location;
  int rows = 0, columns = 0, samples = 1, frames = 1;
  int bits_allocated = 0, bits_stored = 0, high_bit = 0;
  bool is_signed = false;
  double slope = 1, intercept = 0;   // Hounsfield units = slope * value + intercept
  std::optional<double> padding_hu;  // of pixels outside the picture

  std::size_t bytes() const {
    return static_cast<std::size_t>(rows) * static_cast<std::size_t>(columns) *
           static_cast<std::size_t>(bits_allocated / 8);
  }
};

/// What is read of the header of one slice: geometry and how it was made. Identifiers are kept as
/// hashes, to be compared; names, dates and descriptions are not read.
struct SliceHeader {
  std::filesystem::path file;  // not for people
  int place = 0;               // of the file in the folder, by name
  int number = 0;              // of the file in its series, by name, from 1
  SlicePixels pixels;
  std::optional<Eigen::Vector3d> position;              // of the first pixel's centre, mm, LPS
  Eigen::Vector3d along_row = Eigen::Vector3d::Zero();  // unit directions, LPS; zero: not usable
  Eigen::Vector3d along_column = Eigen::Vector3d::Zero();
  double column_spacing_mm = 0, row_spacing_mm = 0;  // between columns, between rows
  std::uint64_t patient = 0, study = 0, series = 0, frame_of_reference = 0, instance = 0;
  std::uint64_t image_type = 0, acquisition = 0;
  bool is_scout = false, is_ct = false;
  int series_number = 0;
  std::string modality, kernel, manufacturer;  // as they may be shown, see shown_facts.h
  std::uint64_t kernel_text = 0;
  double kvp = 0, thickness_mm = 0;
  std::string problem;  // not empty: why the slice cannot be part of a volume
};

enum class DicomFileKind { slice, without_image, not_dicom, empty, damaged };

struct FileHeader {
  DicomFileKind kind = DicomFileKind::not_dicom;
  SliceHeader slice;  // of DicomFileKind::slice
};

/// Reads the header of one file. Never throws on bad content.
FileHeader read_file_header(const std::filesystem::path& file);

}  // namespace condyle
