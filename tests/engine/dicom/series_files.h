// A CT series of a few small slices, whose files a test changes before it reads them.
#pragma once

#include <functional>
#include <string>
#include <vector>

#include "engine/dicom/ct_folder.h"
#include "engine/dicom/write_ct_series.h"
#include "tests/support/program.h"

namespace condyle::test {

/// 24 x 20 x 9 values, 0.5 x 0.6 x 1.5 mm apart, that are linear in the position.
Volume small_volume();
/// The value of small_volume() at a position, not rounded.
double small_volume_hu(const Eigen::Vector3d& position);

/// Replaces the value of an element at the top level of an uncompressed file; adds it where it is
/// absent. `type`: of two letters, with a short length.
void set_element(std::string& file, std::uint32_t tag, std::string value, const char* type);
void remove_element(std::string& file, std::uint32_t tag);
/// The value of an element with a short length, without padding.
std::string element(const std::string& file, std::uint32_t tag);

/// The files of a series in a folder of their own.
class SeriesFiles {
 public:
  explicit SeriesFiles(const Volume& volume = small_volume(), const CtWriteOptions& options = {});
  std::vector<std::string>& files() { return files_; }
  std::string& operator[](std::size_t i) { return files_[i]; }
  void each(const std::function<void(std::string&)>& change);

  /// Writes the files below the folder, with names that begin with `prefix`, in this order.
  void save(const std::string& prefix = "s");
  /// Writes another file beside them.
  void add(const std::string& name, const std::string& content);
  std::filesystem::path path() const { return folder_.path() / "scan"; }

 private:
  Folder folder_;
  std::vector<std::string> files_;
};

/// The message of the InputError with which the series is refused; fails the test if it is read.
std::string refusal(const CtFolder& folder, const CtRequest& request = {});

}  // namespace condyle::test
