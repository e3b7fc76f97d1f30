#include "sim/motion/recording_files.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <limits>

#include "engine/core/error.h"
#include "engine/core/files.h"
#include "sim/case/json_file.h"
#include "sim/motion/condylar_kinematics.h"

namespace condyle {
namespace {

using Eigen::Vector3d;
namespace fs = std::filesystem;

constexpr std::size_t largest_file = std::size_t{256} << 20;

bool is_number(std::string_view text) {
  try {
    parse_number({}, {}, text);
    return true;
  } catch (const InputError&) {
    return false;
  }
}

char separator_of(std::string_view line) {
  for (const char c : {',', ';', '\t'})
    if (line.find(c) != std::string_view::npos) return c;
  return ' ';
}

std::vector<std::string> texts(const std::vector<std::string_view>& fields) {
  return {fields.begin(), fields.end()};
}

RecordingMap with_sidecar(const fs::path& file, const RecordingMap& defaults) {
  const auto sidecar = sidecar_of(file);
  return sidecar ? read_sidecar(*sidecar, defaults) : defaults;
}

/// Times of the rows, from a column or from the rate; they must increase.
std::vector<double> times_of(const fs::path& file, const NumberTable& table,
                             const RecordingMap& map, std::optional<std::size_t> column) {
  std::vector<double> times;
  if (!column && !(map.rate_hz > 0))
    throw InputError(file, "",
                     "has no times; give the rows per second in a sidecar file " +
                         file.filename().string() + ".json: {\"rate_hz\": 100}");
  if (column && map.time_unit_s == 1) check_times(file, table, *column);
  for (std::size_t r = 0; r < table.rows(); ++r)
    times.push_back(column ? table.at(r, *column) * map.time_unit_s
                           : static_cast<double>(r) / map.rate_hz);
  for (std::size_t r = 1; r < times.size(); ++r)
    if (!(times[r] > times[r - 1]))
      throw InputError(file, table.where(r, column.value_or(0)),
                       "is not later than the previous row; sort the rows by time");
  return times;
}

/// Reads the columns that the poses need.
RecordingFile from_columns(const fs::path& file, TextLines& lines, std::vector<std::string> names,
                           char separator, const RecordingMap& map, std::string format) {
  NumberTable head;
  head.names = names;
  head.header_line = std::max<std::size_t>(lines.number(), 1);
  std::vector<std::size_t> needed;
  std::optional<std::size_t> time;
  if (map.rate_hz == 0 && !map.time.empty()) {
    time = column_of(file, head, map.time);
    needed.push_back(*time);
  }
  const auto need = [&](const BodyColumns& body) {
    if (!body.markers.empty()) throw InputError(file, "", "markers are read from .trc files only");
    for (const auto* columns : {&body.translation, &body.turn})
      for (const auto& name : *columns) needed.push_back(column_of(file, head, name));
  };
  need(map.mandible);
  if (map.cranium) need(*map.cranium);
  const std::size_t header = head.header_line;
  NumberTable table = read_rows(file, lines, std::move(names), separator, needed);
  table.header_line = header;
  if (table.rows() == 0) throw InputError(file, "", "the file has a header but no pose");
  const std::vector<double> times = times_of(file, table, map, time);
  RecordingFile out{std::move(format), map,
                    poses_from_columns(file, table, map, map.mandible, times)};
  if (map.cranium) out.cranium = poses_from_columns(file, table, map, *map.cranium, times);
  return out;
}

/// Refuses a file whose rows are too short for a position and a rotation.
[[noreturn]] void refuse_positions(const fs::path& file, const std::string& where,
                                   std::size_t width) {
  throw InputError(
      file, where,
      fmt::format(
          "has {} columns, at most the path of a point, which does not give the rotation of the "
          "jaw. A recording needs position and rotation, as in "
          "time_s,tx_mm,ty_mm,tz_mm,qw,qx,qy,qz, or at least three markers (.trc); the sidecar "
          "file {}.json gives the columns of the file where they have other names",
          width, file.filename().string()));
}

RecordingFile read_named_columns(const fs::path& file, TextLines& lines) {
  RecordingMap defaults;
  defaults.mandible = {.rotation = BodyColumns::Rotation::quaternion,
                       .translation = {"tx_mm", "ty_mm", "tz_mm"},
                       .turn = {"qw", "qx", "qy", "qz"}};
  const RecordingMap map = with_sidecar(file, defaults);
  const char separator = separator_of(lines.line());
  auto names = texts(fields_of(lines.line(), separator));
  const std::size_t width = names.size();
  try {
    return from_columns(file, lines, std::move(names), separator, map, "table of poses");
  } catch (const InputError& error) {
    const std::string problem = error.what();
    if (sidecar_of(file) || problem.find(" is missing; the columns are") == std::string::npos)
      throw;
    if (width <= 4) refuse_positions(file, lines.where(), width);
    throw InputError(problem +
                     "; a pose file starts with the header time_s,tx_mm,ty_mm,tz_mm,qw,qx,qy,qz, "
                     "or a sidecar file " +
                     file.filename().string() + ".json names its columns");
  }
}

std::vector<std::string> numbered(std::size_t first, std::size_t count) {
  std::vector<std::string> names;
  for (std::size_t i = 0; i < count; ++i) names.push_back("#" + std::to_string(first + i));
  return names;
}

/// Rows of bare numbers: a 4x4 pose each, with or without the time before it.
RecordingFile read_matrices(const fs::path& file, std::string_view content) {
  TextLines lines(content);
  lines.next_filled();
  const char separator = separator_of(lines.line());
  const std::size_t width = fields_of(lines.line(), separator).size();
  if (width < 16 || (width % 16 != 0 && width % 16 != 1))
    throw InputError(file, lines.where(),
                     fmt::format("{} numbers without a header; a 4x4 pose has 16, or 17 with the "
                                 "time first",
                                 width));
  const std::size_t first = width % 16 + 1;
  RecordingMap defaults;
  defaults.time = first == 2 ? "#1" : "";
  defaults.mandible = {.rotation = BodyColumns::Rotation::matrix, .turn = numbered(first, 16)};
  TextLines rows(content);
  return from_columns(file, rows, numbered(1, width), separator, with_sidecar(file, defaults),
                      "4x4 rows");
}

/// ArtiSynth's text of a numeric probe.
RecordingFile read_probe(const fs::path& file, TextLines& lines) {
  const auto start = fields_of(lines.line(), ' ');
  // Start and stop are ignored: time is counted from the first row.
  const double scale = parse_number(file, lines.where() + ", scale", start[2]);
  lines.next_filled();
  const auto head = fields_of(lines.line(), ' ');
  if (head.size() < 3)
    throw InputError(
        file, lines.where(),
        "the second line of a probe must hold interpolation, number of columns and time step");
  const double count = parse_number(file, lines.where() + ", columns", head[1]);
  if (count != 12 && count != 16)
    throw InputError(file, lines.where(),
                     fmt::format("the probe has {} columns; a pose has 16 (4x4) or 12 (3x4)",
                                 shortened(head[1])));
  const auto n = static_cast<std::size_t>(count);
  const bool explicit_times = lower_case(head[2]) == "explicit";
  RecordingMap defaults;
  defaults.time = explicit_times ? "#1" : "";
  const std::size_t first = explicit_times ? 2 : 1;
  if (!explicit_times) {
    const double step_s = parse_number(file, lines.where() + ", time step", head[2]) * scale;
    if (!(step_s > 1e-6 && step_s <= 60))
      throw InputError(file, lines.where(),
                       fmt::format("a time step of {} s is not between 1e-6 and 60", step_s));
    defaults.rate_hz = 1 / step_s;
  }
  defaults.mandible.rotation = BodyColumns::Rotation::matrix;
  defaults.mandible.turn = numbered(first, 16);
  if (n == 12) {  // rows of three and one
    defaults.mandible.turn.clear();
    for (const std::size_t k : {0u, 1u, 2u, 4u, 5u, 6u, 8u, 9u, 10u})
      defaults.mandible.turn.push_back("#" + std::to_string(first + k));
    for (const std::size_t k : {3u, 7u, 11u})
      defaults.mandible.translation.push_back("#" + std::to_string(first + k));
  }
  return from_columns(file, lines, numbered(1, n + first - 1), ' ', with_sidecar(file, defaults),
                      "ArtiSynth probe");
}

/// OpenSim: lengths in metres, x forward, y up, z right; angle unit from the header.
RecordingFile read_opensim(const fs::path& file, std::string_view content) {
  TextLines lines(content);
  RecordingMap defaults;
  defaults.time = "time";
  defaults.length_unit_mm = 1000;
  defaults.source = source_frame("mm", "ASR");
  bool ended = false;
  while (!ended && lines.next()) {
    const std::string line = lower_case(trimmed(lines.line()));
    if (line == "indegrees=yes") defaults.angle_unit_rad = degree;
    ended = line == "endheader";
  }
  if (!lines.next_filled()) throw InputError(file, "", "there are no columns after endheader");
  auto names = texts(
      fields_of(lines.line(), lines.line().find('\t') != std::string_view::npos ? '\t' : ' '));
  // Coordinates of one free joint: NAME_tx, NAME_ty, NAME_tz and NAME_rx, NAME_ry, NAME_rz.
  std::string joint;
  int joints = 0;
  for (const auto& name : names)
    if (lower_case(name).ends_with("_tx")) joint = name.substr(0, name.size() - 2), ++joints;
  defaults.mandible = {.rotation = BodyColumns::Rotation::euler,
                       .translation = {joint + "tx", joint + "ty", joint + "tz"},
                       .turn = {joint + "rx", joint + "ry", joint + "rz"}};
  if (joints != 1 && !sidecar_of(file))
    throw InputError(file, lines.where(),
                     fmt::format("{} columns end with _tx, so those of the mandible are ambiguous; "
                                 "name them in the sidecar file {}.json",
                                 joints, file.filename().string()));
  return from_columns(file, lines, std::move(names), ' ', with_sidecar(file, defaults),
                      "OpenSim storage");
}

struct TrcHeader {
  double unit_mm = 1;
  std::vector<std::string> markers;
};

TrcHeader read_trc_header(const fs::path& file, TextLines& lines) {
  const auto next = [&] {
    if (!lines.next())
      throw InputError(file, "", "ends within its header; a .trc file has five header lines");
    return fields_of(lines.line(), '\t');
  };
  lines.next();  // PathFileType
  const auto keys = next(), values = next();
  TrcHeader head;
  for (std::size_t k = 0; k < std::min(keys.size(), values.size()); ++k) {
    if (lower_case(keys[k]) != "units") continue;
    const std::string unit = lower_case(values[k]);
    if (unit == "m")
      head.unit_mm = 1000;
    else if (unit == "cm")
      head.unit_mm = 10;
    else if (unit != "mm")
      throw InputError(file, lines.where() + ", Units",
                       "\"" + shortened(values[k]) + "\" is unknown; valid units are mm, cm, m");
  }
  const auto names = next();
  if (names.size() < 3 || lower_case(names[0]).find("frame") == std::string::npos)
    throw InputError(file, lines.where(),
                     "should start with Frame#, Time and the names of the markers");
  for (std::size_t k = 2; k < names.size(); ++k)
    if (!names[k].empty()) head.markers.emplace_back(names[k]);
  if (head.markers.empty()) throw InputError(file, lines.where(), "names no marker");
  next();  // X1 Y1 Z1 ...
  return head;
}

RecordingFile read_trc(const fs::path& file, std::string_view content) {
  TextLines lines(content);
  const TrcHeader head = read_trc_header(file, lines);
  RecordingMap defaults;
  defaults.first_is_rest = true;
  defaults.source = source_frame("mm", "ASR");
  defaults.mandible.markers = head.markers;
  defaults.length_unit_mm = head.unit_mm;
  RecordingFile out{"markers (.trc)", with_sidecar(file, defaults), {}};
  MarkerTable table{head.markers, {}, {}, {}};
  table.markers.resize(head.markers.size());
  const Vector3d unseen = Vector3d::Constant(std::numeric_limits<double>::quiet_NaN());
  while (lines.next_filled()) {
    const auto fields = fields_of(lines.line(), '\t');
    if (fields.size() < 2)
      throw InputError(file, lines.where(), "has no time; the file may be truncated");
    const double time_s = parse_number(file, lines.where() + ", Time", fields[1]);
    if (!table.time_s.empty() && !(time_s > table.time_s.back()))
      throw InputError(
          file, lines.where() + ", Time",
          fmt::format("{} is not later than {} of the previous row", time_s, table.time_s.back()));
    table.time_s.push_back(time_s);
    table.lines.push_back(lines.number());
    for (std::size_t m = 0; m < head.markers.size(); ++m) {
      Vector3d p = unseen;
      for (std::size_t k = 0; k < 3; ++k) {
        const std::size_t c = 2 + 3 * m + k;
        if (c >= fields.size() || fields[c].empty() || lower_case(fields[c]) == "nan") continue;
        p[static_cast<int>(k)] =
            out.map.length_unit_mm *
            parse_number(file, lines.where() + ", " + shortened(head.markers[m]), fields[c]);
      }
      table.markers[m].push_back(p);
    }
  }
  if (table.time_s.empty()) throw InputError(file, "", "the file has a header but no row");
  const auto poses = [&](const BodyColumns& body) {
    if (body.markers.empty())
      throw InputError(file, "",
                       "a .trc file contains markers; list those of each body under markers");
    return poses_from_markers(file, table, body.markers);
  };
  out.mandible = poses(out.map.mandible);
  if (out.map.cranium) out.cranium = poses(*out.map.cranium);
  return out;
}

bool begins_with_probe(std::string_view first, std::string_view second) {
  const auto start = fields_of(first, ' '), head = fields_of(second, ' ');
  if (start.size() != 3 || head.empty() || !std::all_of(start.begin(), start.end(), is_number))
    return false;
  const std::string kind = lower_case(head[0]);
  return kind.find("step") != std::string::npos || kind.find("linear") != std::string::npos ||
         kind.find("cubic") != std::string::npos;
}

}  // namespace

RecordingFile read_recording_file(const fs::path& file) {
  const std::string content = read_file(file, largest_file);
  TextLines lines(content), ahead(content);
  if (!lines.next_filled()) throw InputError(file, "", "the file is empty");
  ahead.next_filled();
  if (lower_case(file.extension().string()) == ".json")
    throw InputError(file, "",
                     "is not a motion: a JSON file is the sidecar of the motion file whose name "
                     "precedes .json");
  if (trimmed(lines.line()).starts_with("PathFileType")) return read_trc(file, content);
  const bool second = ahead.next_filled();
  if (second && begins_with_probe(lines.line(), ahead.line())) return read_probe(file, lines);
  constexpr std::size_t header_bytes = 20000;
  const std::string head = lower_case(std::string_view(content).substr(0, header_bytes));
  if (head.find("\nendheader") != std::string::npos) return read_opensim(file, content);
  const auto fields = fields_of(lines.line(), separator_of(lines.line()));
  if (fields.size() >= 16 && is_number(fields[0]) && is_number(fields[1]))
    return read_matrices(file, content);
  if (fields.size() <= 4 && !sidecar_of(file) &&
      std::all_of(fields.begin(), fields.end(), is_number))
    refuse_positions(file, lines.where(), fields.size());
  return read_named_columns(file, lines);
}

}  // namespace condyle
