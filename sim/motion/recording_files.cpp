#include "sim/motion/recording_files.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <limits>

#include "engine/core/error.h"
#include "engine/core/files.h"
#include "sim/case/json_file.h"
#include "sim/motion/condylar_path.h"

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

RecordingMap with_sidecar(const fs::path& file, const RecordingMap& usual) {
  const auto sidecar = sidecar_of(file);
  return sidecar ? read_sidecar(*sidecar, usual) : usual;
}

/// Times of rows, from a column or from the rate; they must increase.
std::vector<double> times_of(const fs::path& file, const NumberTable& table,
                             const RecordingMap& map, std::optional<std::size_t> column) {
  std::vector<double> times;
  if (!column && !(map.rate_hz > 0))
    throw InputError(file, "",
                     "has no times; tell how many rows make a second in a file beside it, " +
                         file.filename().string() + ".json: {\"rate_hz\": 100}");
  if (column && map.time_unit_s == 1) check_times(file, table, *column);
  for (std::size_t r = 0; r < table.rows(); ++r)
    times.push_back(column ? table.at(r, *column) * map.time_unit_s
                           : static_cast<double>(r) / map.rate_hz);
  for (std::size_t r = 1; r < times.size(); ++r)
    if (!(times[r] > times[r - 1]))
      throw InputError(file, table.where(r, column.value_or(0)),
                       "does not come after the row before; sort the rows by time");
  return times;
}

/// Reads those columns of the rows that the poses need.
RecordingFile from_columns(const fs::path& file, TextLines& lines, std::vector<std::string> names,
                           char separator, const RecordingMap& map, std::string format) {
  NumberTable head;
  head.names = names;
  head.header_line = std::max<std::size_t>(lines.number(), 1);
  std::vector<std::size_t> wanted;
  std::optional<std::size_t> time;
  if (map.rate_hz == 0 && !map.time.empty()) {
    time = column_of(file, head, map.time);
    wanted.push_back(*time);
  }
  const auto want = [&](const BodyColumns& body) {
    if (!body.markers.empty()) throw InputError(file, "", "markers are only read from .trc files");
    for (const auto* columns : {&body.translation, &body.turn})
      for (const auto& name : *columns) wanted.push_back(column_of(file, head, name));
  };
  want(map.mandible);
  if (map.cranium) want(*map.cranium);
  const std::size_t header = head.header_line;
  NumberTable table = read_rows(file, lines, std::move(names), separator, wanted);
  table.header_line = header;
  if (table.rows() == 0) throw InputError(file, "", "there is a header but no pose");
  const std::vector<double> times = times_of(file, table, map, time);
  RecordingFile out{std::move(format), map,
                    poses_from_columns(file, table, map, map.mandible, times)};
  if (map.cranium) out.cranium = poses_from_columns(file, table, map, *map.cranium, times);
  return out;
}

RecordingFile read_named_columns(const fs::path& file, TextLines& lines) {
  RecordingMap usual;
  usual.mandible = {.rotation = BodyColumns::Rotation::quaternion,
                    .translation = {"tx_mm", "ty_mm", "tz_mm"},
                    .turn = {"qw", "qx", "qy", "qz"}};
  const RecordingMap map = with_sidecar(file, usual);
  const char separator = separator_of(lines.line());
  auto names = texts(fields_of(lines.line(), separator));
  try {
    return from_columns(file, lines, std::move(names), separator, map, "table of poses");
  } catch (const InputError& error) {
    const std::string problem = error.what();
    if (sidecar_of(file) || problem.find(" is missing; there are") == std::string::npos) throw;
    throw InputError(problem +
                     "; a pose file starts with the header time_s,tx_mm,ty_mm,tz_mm,qw,qx,qy,qz, "
                     "or a file beside it, " +
                     file.filename().string() + ".json, tells its columns");
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
                     fmt::format("{} numbers without a header; a row of a 4x4 pose has 16, or 17 "
                                 "with the time first",
                                 width));
  const std::size_t first = width % 16 + 1;
  RecordingMap usual;
  usual.time = first == 2 ? "#1" : "";
  usual.mandible = {.rotation = BodyColumns::Rotation::matrix, .turn = numbered(first, 16)};
  TextLines rows(content);
  return from_columns(file, rows, numbered(1, width), separator, with_sidecar(file, usual),
                      "4x4 rows");
}

/// ArtiSynth's text of a numeric probe.
RecordingFile read_probe(const fs::path& file, TextLines& lines) {
  const auto start = fields_of(lines.line(), ' ');
  // Start and stop are left: times count from the first row.
  const double scale = parse_number(file, lines.where() + ", scale", start[2]);
  lines.next_filled();
  const auto head = fields_of(lines.line(), ' ');
  if (head.size() < 3)
    throw InputError(file, lines.where(),
                     "a probe's second line holds interpolation, number of columns, and time step");
  const double count = parse_number(file, lines.where() + ", columns", head[1]);
  if (count != 12 && count != 16)
    throw InputError(file, lines.where(),
                     fmt::format("the probe has {} columns; a pose has 16 (4x4) or 12 (3x4)",
                                 shortened(head[1])));
  const auto n = static_cast<std::size_t>(count);
  const bool explicit_times = lower_case(head[2]) == "explicit";
  RecordingMap usual;
  usual.time = explicit_times ? "#1" : "";
  const std::size_t first = explicit_times ? 2 : 1;
  if (!explicit_times) {
    const double step_s = parse_number(file, lines.where() + ", time step", head[2]) * scale;
    if (!(step_s > 1e-6 && step_s <= 60))
      throw InputError(file, lines.where(),
                       fmt::format("a time step of {} s is not between 1e-6 and 60", step_s));
    usual.rate_hz = 1 / step_s;
  }
  usual.mandible.rotation = BodyColumns::Rotation::matrix;
  usual.mandible.turn = numbered(first, 16);
  if (n == 12) {  // rows of three and one
    usual.mandible.turn.clear();
    for (const std::size_t k : {0u, 1u, 2u, 4u, 5u, 6u, 8u, 9u, 10u})
      usual.mandible.turn.push_back("#" + std::to_string(first + k));
    for (const std::size_t k : {3u, 7u, 11u})
      usual.mandible.translation.push_back("#" + std::to_string(first + k));
  }
  return from_columns(file, lines, numbered(1, n + first - 1), ' ', with_sidecar(file, usual),
                      "ArtiSynth probe");
}

/// OpenSim: lengths in metres, x forward, y up, z right; angles as the header tells.
RecordingFile read_opensim(const fs::path& file, std::string_view content) {
  TextLines lines(content);
  RecordingMap usual;
  usual.time = "time";
  usual.length_unit_mm = 1000;
  usual.axes = "ASR";
  bool ended = false;
  while (!ended && lines.next()) {
    const std::string line = lower_case(trimmed(lines.line()));
    if (line == "indegrees=yes") usual.angle_unit_rad = radian_per_degree;
    ended = line == "endheader";
  }
  if (!lines.next_filled()) throw InputError(file, "", "there is no column after endheader");
  auto names = texts(
      fields_of(lines.line(), lines.line().find('\t') != std::string_view::npos ? '\t' : ' '));
  // Coordinates of one free joint: NAME_tx, NAME_ty, NAME_tz and NAME_rx, NAME_ry, NAME_rz.
  std::string joint;
  int joints = 0;
  for (const auto& name : names)
    if (lower_case(name).ends_with("_tx")) joint = name.substr(0, name.size() - 2), ++joints;
  usual.mandible = {.rotation = BodyColumns::Rotation::euler,
                    .translation = {joint + "tx", joint + "ty", joint + "tz"},
                    .turn = {joint + "rx", joint + "ry", joint + "rz"}};
  if (joints != 1 && !sidecar_of(file))
    throw InputError(file, lines.where(),
                     fmt::format("{} columns end with _tx, so it is not known which are the "
                                 "mandible's; tell its columns in a file beside it, {}.json",
                                 joints, file.filename().string()));
  return from_columns(file, lines, std::move(names), ' ', with_sidecar(file, usual),
                      "OpenSim storage");
}

struct TrcHeader {
  double unit_mm = 1;
  std::vector<std::string> markers;
};

TrcHeader read_trc_header(const fs::path& file, TextLines& lines) {
  const auto next = [&] {
    if (!lines.next())
      throw InputError(file, "", "ends within its header; a .trc file has five lines of it");
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
                       "\"" + shortened(values[k]) + "\" is not known; known are mm, cm, m");
  }
  const auto names = next();
  if (names.size() < 3 || lower_case(names[0]).find("frame") == std::string::npos)
    throw InputError(file, lines.where(), "should begin with Frame#, Time and the markers' names");
  for (std::size_t k = 2; k < names.size(); ++k)
    if (!names[k].empty()) head.markers.emplace_back(names[k]);
  if (head.markers.empty()) throw InputError(file, lines.where(), "names no marker");
  next();  // X1 Y1 Z1 ...
  return head;
}

RecordingFile read_trc(const fs::path& file, std::string_view content) {
  TextLines lines(content);
  const TrcHeader head = read_trc_header(file, lines);
  RecordingMap usual;
  usual.first_is_rest = true;
  usual.axes = "ASR";
  usual.mandible.markers = head.markers;
  usual.length_unit_mm = head.unit_mm;
  RecordingFile out{"markers (.trc)", with_sidecar(file, usual), {}};
  MarkerTable table{head.markers, {}, {}, {}};
  table.markers.resize(head.markers.size());
  const Vector3d unseen = Vector3d::Constant(std::numeric_limits<double>::quiet_NaN());
  while (lines.next_filled()) {
    const auto fields = fields_of(lines.line(), '\t');
    if (fields.size() < 2)
      throw InputError(file, lines.where(), "has no time; the file may be cut off");
    const double time_s = parse_number(file, lines.where() + ", Time", fields[1]);
    if (!table.time_s.empty() && !(time_s > table.time_s.back()))
      throw InputError(
          file, lines.where() + ", Time",
          fmt::format("{} does not come after {} of the row before", time_s, table.time_s.back()));
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
  if (table.time_s.empty()) throw InputError(file, "", "there is a header but no row");
  const auto poses = [&](const BodyColumns& body) {
    if (body.markers.empty())
      throw InputError(file, "", "a .trc file holds markers; name those of each body as markers");
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
                     "is no motion: a JSON file only tells what stands in the motion beside it, "
                     "whose name it has with .json behind");
  if (trimmed(lines.line()).starts_with("PathFileType")) return read_trc(file, content);
  const bool second = ahead.next_filled();
  if (second && begins_with_probe(lines.line(), ahead.line())) return read_probe(file, lines);
  constexpr std::size_t header_bytes = 20000;
  const std::string head = lower_case(std::string_view(content).substr(0, header_bytes));
  if (head.find("\nendheader") != std::string::npos) return read_opensim(file, content);
  const auto fields = fields_of(lines.line(), separator_of(lines.line()));
  if (fields.size() >= 16 && is_number(fields[0]) && is_number(fields[1]))
    return read_matrices(file, content);
  return read_named_columns(file, lines);
}

}  // namespace condyle
