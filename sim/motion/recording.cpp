#include "sim/motion/recording.h"

#include <fmt/core.h>

#include <algorithm>
#include <array>
#include <cctype>
#include <charconv>
#include <cmath>
#include <memory>
#include <string_view>

#include "engine/core/error.h"
#include "engine/core/files.h"

namespace condyle {
namespace {

constexpr std::size_t largest_file = std::size_t{256} << 20;
constexpr double farthest_mm = 1000;
constexpr double longest_s = 86400;
constexpr double unit_tolerance = 1e-3;  // of a quaternion's length: files have few digits

constexpr std::array<std::string_view, 8> column_names = {"time_s", "tx_mm", "ty_mm", "tz_mm",
                                                          "qw",     "qx",    "qy",    "qz"};

struct Recording {
  std::vector<double> time_s;  // from 0, increasing
  std::vector<Pose> X_CM;      // neighbours on the same side of the double cover
};

std::string_view trim(std::string_view text) {
  const auto blank = [](char c) {
    return c == ' ' || c == '\t' || c == '\r' || c == '\n' || c == '"';
  };
  while (!text.empty() && blank(text.front())) text.remove_prefix(1);
  while (!text.empty() && blank(text.back())) text.remove_suffix(1);
  return text;
}

/// Takes the next line off `rest`.
std::string_view next_line(std::string_view& rest) {
  const std::size_t end = std::min(rest.find('\n'), rest.size());
  const std::string_view line = rest.substr(0, end);
  rest.remove_prefix(std::min(end + 1, rest.size()));
  return line;
}

std::vector<std::string_view> split(std::string_view line) {
  std::vector<std::string_view> fields;
  for (;;) {
    const std::size_t comma = line.find(',');
    fields.push_back(trim(line.substr(0, comma)));
    if (comma == std::string_view::npos) return fields;
    line.remove_prefix(comma + 1);
  }
}

std::string shortened(std::string_view text) {
  return text.size() <= 40 ? std::string(text) : std::string(text.substr(0, 40)) + "...";
}

/// Where each of our columns stands in the file.
std::array<std::size_t, 8> find_columns(const std::filesystem::path& file,
                                        std::string_view header) {
  std::array<std::size_t, 8> columns{};
  const auto fields = split(header);
  for (std::size_t c = 0; c < columns.size(); ++c) {
    const auto same = [&](std::string_view field) {
      return std::equal(field.begin(), field.end(), column_names[c].begin(), column_names[c].end(),
                        [](unsigned char x, unsigned char y) { return std::tolower(x) == y; });
    };
    const auto found = std::find_if(fields.begin(), fields.end(), same);
    if (found == fields.end())
      throw InputError(file, "line 1",
                       fmt::format("column {} is missing; a pose file starts with the header "
                                   "time_s,tx_mm,ty_mm,tz_mm,qw,qx,qy,qz (found \"{}\")",
                                   column_names[c], shortened(trim(header))));
    if (std::find_if(found + 1, fields.end(), same) != fields.end())
      throw InputError(file, "line 1", fmt::format("column {} stands twice", column_names[c]));
    columns[c] = static_cast<std::size_t>(found - fields.begin());
  }
  return columns;
}

double parse(const std::filesystem::path& file, std::size_t line, std::string_view column,
             std::string_view text) {
  const auto item = [&] { return fmt::format("line {}, {}", line, column); };
  std::string_view digits = text;
  if (!digits.empty() && digits.front() == '+') digits.remove_prefix(1);
  double value = 0;
  const auto [end, error] = std::from_chars(digits.data(), digits.data() + digits.size(), value);
  if (error != std::errc{} || end != digits.data() + digits.size())
    throw InputError(file, item(), fmt::format("\"{}\" is not a number", shortened(text)));
  if (!std::isfinite(value))
    throw InputError(file, item(), fmt::format("{} is not a finite number", text));
  return value;
}

/// One row's pose; `before` fixes the sign of the quaternion.
Pose read_pose(const std::filesystem::path& file, std::size_t line,
               const std::array<double, 8>& row, const Pose* before) {
  for (std::size_t c = 1; c <= 3; ++c)
    if (std::abs(row[c]) > farthest_mm)
      throw InputError(file, fmt::format("line {}, {}", line, column_names[c]),
                       fmt::format("{} mm is farther than {} mm; translations are in millimetres",
                                   row[c], farthest_mm));
  Pose pose;
  pose.t = {row[1], row[2], row[3]};
  pose.R = Eigen::Quaterniond(row[4], row[5], row[6], row[7]);
  const double length = pose.R.norm();
  if (!(std::abs(length - 1) <= unit_tolerance))
    throw InputError(file, fmt::format("line {}, qw qx qy qz", line),
                     fmt::format("the quaternion ({}, {}, {}, {}) has length {:.6g}; it must be 1",
                                 row[4], row[5], row[6], row[7], length));
  pose.R.normalize();
  if (before && before->R.dot(pose.R) < 0) pose.R.coeffs() = -pose.R.coeffs();
  return pose;
}

Recording parse_recording(const std::filesystem::path& file) {
  const std::string content = read_file(file, largest_file);
  std::string_view rest = content;
  if (rest.starts_with("\xEF\xBB\xBF")) rest.remove_prefix(3);  // byte order mark
  if (trim(rest).empty()) throw InputError(file, "", "the file is empty");
  const auto columns = find_columns(file, next_line(rest));
  const std::size_t needed = *std::max_element(columns.begin(), columns.end()) + 1;

  Recording recording;
  double first_s = 0, before_s = 0;
  for (std::size_t line = 2; !rest.empty(); ++line) {
    const std::string_view text = next_line(rest);
    if (trim(text).empty()) continue;
    const auto fields = split(text);
    if (fields.size() < needed)
      throw InputError(
          file, fmt::format("line {}", line),
          fmt::format("{} values where at least {} are needed (\"{}\"); the file may be "
                      "cut off",
                      fields.size(), needed, shortened(trim(text))));
    std::array<double, 8> row{};
    for (std::size_t c = 0; c < row.size(); ++c)
      row[c] = parse(file, line, column_names[c], fields[columns[c]]);
    if (recording.time_s.empty())
      first_s = row[0];
    else if (row[0] <= before_s)
      throw InputError(
          file, fmt::format("line {}, time_s", line),
          fmt::format("{} does not come after {} of the row before; sort the rows by time", row[0],
                      before_s));
    if (row[0] - first_s > longest_s)
      throw InputError(file, fmt::format("line {}, time_s", line),
                       fmt::format("{} is more than {} s after the first row; times are in seconds",
                                   row[0], longest_s));
    before_s = row[0];
    const Pose pose =
        read_pose(file, line, row, recording.X_CM.empty() ? nullptr : &recording.X_CM.back());
    recording.time_s.push_back(row[0] - first_s);
    recording.X_CM.push_back(pose);
  }
  if (recording.time_s.empty()) throw InputError(file, "", "there is a header but no pose");
  return recording;
}

Pose sample(const Recording& recording, double time_s) {
  const auto& times = recording.time_s;
  if (!(time_s > 0)) return recording.X_CM.front();
  if (time_s >= times.back()) return recording.X_CM.back();
  const std::size_t next = static_cast<std::size_t>(
      std::upper_bound(times.begin(), times.end(), time_s) - times.begin());
  const double s = (time_s - times[next - 1]) / (times[next] - times[next - 1]);
  return interpolate(recording.X_CM[next - 1], recording.X_CM[next], s);
}

}  // namespace

Motion read_recording(const std::filesystem::path& file) {
  const auto recording = std::make_shared<const Recording>(parse_recording(file));
  return {file.stem().string(),
          recording->time_s.back(),
          true,
          [recording](double time_s) { return sample(*recording, time_s); },
          {},
          recording->time_s};
}

}  // namespace condyle
