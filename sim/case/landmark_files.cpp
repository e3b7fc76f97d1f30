#include "sim/case/landmark_files.h"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <cctype>
#include <charconv>
#include <cmath>
#include <map>
#include <nlohmann/json.hpp>
#include <optional>

#include "engine/core/error.h"
#include "engine/core/files.h"
#include "sim/case/case_io.h"
#include "sim/case/json_file.h"
#include "sim/case/landmark_names.h"

namespace condyle {
namespace {

namespace fs = std::filesystem;

constexpr std::size_t max_landmark_bytes = std::size_t{16} << 20;
constexpr std::size_t max_rows = 100'000;

std::string trimmed(std::string_view text) {
  const auto space = [](char c) { return c == ' ' || c == '\t'; };
  while (!text.empty() && space(text.front())) text.remove_prefix(1);
  while (!text.empty() && space(text.back())) text.remove_suffix(1);
  return std::string(text);
}

std::string lower(std::string text) {
  std::transform(text.begin(), text.end(), text.begin(),
                 [](unsigned char c) { return static_cast<char>(std::tolower(c)); });
  return text;
}

std::string in_quotes(std::string_view text) {
  std::string result = "\"";
  for (const char c : text.substr(0, 40))
    result += std::isprint(static_cast<unsigned char>(c)) ? c : '?';
  return result + (text.size() > 40 ? "...\"" : "\"");
}

/// Fields of one line; quotes may hold separators and doubled quotes.
std::vector<std::string> split(const fs::path& file, const std::string& where,
                               std::string_view line, char separator) {
  std::vector<std::string> fields(1);
  bool quoted = false, was_quoted = false;
  for (std::size_t i = 0; i < line.size(); ++i) {
    const char c = line[i];
    if (quoted) {
      if (c != '"')
        fields.back() += c;
      else if (i + 1 < line.size() && line[i + 1] == '"')
        fields.back() += line[++i];
      else
        quoted = false;
    } else if (c == '"' && !was_quoted && trimmed(fields.back()).empty()) {
      fields.back().clear();
      quoted = was_quoted = true;
    } else if (c == separator) {
      fields.emplace_back();
      was_quoted = false;
    } else {
      fields.back() += c;
    }
  }
  if (quoted) throw InputError(file, where, "a quoted field is not closed");
  for (auto& field : fields) field = trimmed(field);
  return fields;
}

std::optional<double> number(std::string_view text) {
  if (!text.empty() && text.front() == '+') text.remove_prefix(1);
  double value = 0;
  const auto [end, error] = std::from_chars(text.data(), text.data() + text.size(), value);
  if (text.empty() || error != std::errc{} || end != text.data() + text.size()) return std::nullopt;
  return value;
}

LandmarkTable read_csv(const fs::path& file, std::string_view text, bool named) {
  if (text.substr(0, 3) == "\xef\xbb\xbf") text.remove_prefix(3);
  constexpr std::array<const char*, 4> required = {"name", "x_mm", "y_mm", "z_mm"};
  std::array<std::size_t, 4> column{};
  std::size_t columns = 0;
  char separator = ',';
  LandmarkTable table;
  int line_number = 0;
  while (!text.empty()) {
    const std::size_t end = std::min(text.find('\n'), text.size());
    std::string_view line = text.substr(0, end);
    text.remove_prefix(std::min(end + 1, text.size()));
    if (!line.empty() && line.back() == '\r') line.remove_suffix(1);
    const std::string where = fmt::format("line {}", ++line_number);
    if (trimmed(line).empty() || trimmed(line).front() == '#') continue;

    if (columns == 0) {
      if (line.find(',') == std::string_view::npos)
        separator = line.find('\t') != std::string_view::npos ? '\t' : ';';
      const auto header = split(file, where, line, separator);
      columns = header.size();
      for (std::size_t w = 0; w < required.size(); ++w) {
        column[w] = columns;
        for (std::size_t i = 0; i < columns; ++i) {
          if (lower(header[i]) != required[w]) continue;
          if (column[w] < columns)
            throw InputError(file, where,
                             fmt::format("the column \"{}\" appears twice", required[w]));
          column[w] = i;
        }
        if (column[w] == columns && (w > 0 || named))
          throw InputError(file, where,
                           fmt::format("the column \"{}\" is missing (found: {}); the header must "
                                       "contain {}x_mm,y_mm,z_mm",
                                       required[w], in_quotes(line), named ? "name," : ""));
      }
      continue;
    }

    const auto fields = split(file, where, line, separator);
    if (fields.size() != columns)
      throw InputError(file, where,
                       fmt::format("has {} fields, the header has {}", fields.size(), columns));
    LandmarkRow row{column[0] < columns ? fields[column[0]] : "point", {}, where};
    if (named && canonical_landmark(row.name).empty())
      throw InputError(file, where, "the name " + in_quotes(row.name) + " has no letter or digit");
    for (int k = 0; k < 3; ++k) {
      const auto& field = fields[column[static_cast<std::size_t>(k) + 1]];
      const auto value = number(field);
      if (!value || !(std::abs(*value) <= 1e9))
        throw InputError(file, where,
                         fmt::format("{} of {} is {}; it must be a finite number such as 12.5",
                                     required[static_cast<std::size_t>(k) + 1], in_quotes(row.name),
                                     in_quotes(field)));
      row.point[k] = *value;
    }
    table.rows.push_back(std::move(row));
    if (table.rows.size() > max_rows)
      throw InputError(file, where, fmt::format("more than {} landmarks", max_rows));
  }
  if (columns == 0) throw InputError(file, "", "has no header line name,x_mm,y_mm,z_mm");
  return table;
}

/// Sign of x and y that converts the coordinate system of the list to LPS.
double sign_to_lps(const fs::path& file, const JsonItem& markup) {
  const auto system = markup.find("coordinateSystem");
  if (!system) return 1;  // default of 3D Slicer
  const std::string name = system->value().is_number_integer()
                               ? std::to_string(system->value().get<int>())
                               : system->text();
  if (name == "LPS" || name == "1") return 1;
  if (name == "RAS" || name == "0") return -1;
  throw InputError(
      file, system->name(),
      "the coordinate system " + in_quotes(name) + " is unknown; LPS and RAS are supported");
}

LandmarkTable read_markups(const fs::path& file, std::string_view text, bool named) {
  const JsonFile json(file, text);
  LandmarkTable table;
  table.own_frame = true;
  const JsonItem markups = json.root().at("markups");
  for (std::size_t m = 0; m < markups.size(); ++m) {
    const JsonItem markup = markups.at(m);
    const double sign = sign_to_lps(file, markup);
    if (const auto units = markup.find("coordinateUnits"); units && units->text() != "mm")
      throw InputError(file, units->name(),
                       "is " + in_quotes(units->text()) + "; save the points in mm");
    const JsonItem points = markup.at("controlPoints");
    for (std::size_t i = 0; i < points.size(); ++i) {
      const JsonItem point = points.at(i);
      if (const auto status = point.find("positionStatus"); status && status->text() != "defined")
        continue;
      LandmarkRow row;
      if (named || point.find("label")) row.name = point.at("label").text();
      row.where = point.name();
      if (named && canonical_landmark(row.name).empty())
        throw InputError(file, row.where,
                         "the label " + in_quotes(row.name) + " has no letter or digit");
      const JsonItem position = point.at("position");
      if (position.size() != 3)
        throw InputError(file, position.name(),
                         fmt::format("has {} numbers; 3 are required", position.size()));
      for (int k = 0; k < 3; ++k)
        row.point[k] =
            position.at(static_cast<std::size_t>(k)).number(-1e9, 1e9) * (k < 2 ? sign : 1);
      table.rows.push_back(std::move(row));
    }
  }
  return table;
}

LandmarkTable read_points(const fs::path& file, bool named) {
  if (std::error_code error; fs::is_directory(file, error))
    throw InputError(file, "", "is a folder; give a .csv or .mrk.json file");
  const std::string extension = lower(file.extension().string());
  if (extension != ".csv" && extension != ".json" && extension != ".txt" && extension != ".tsv")
    throw InputError(file, "",
                     fmt::format("{} are read from .csv ({}x_mm,y_mm,z_mm) and .mrk.json files",
                                 named ? "landmarks" : "points", named ? "name," : ""));
  const std::string text = read_file(file, max_landmark_bytes);
  LandmarkTable table =
      extension == ".json" ? read_markups(file, text, named) : read_csv(file, text, named);
  if (table.rows.empty())
    throw InputError(file, "", named ? "contains no landmarks" : "contains no points");
  return table;
}

}  // namespace

LandmarkTable read_landmark_table(const fs::path& file) { return read_points(file, true); }

LandmarkTable read_point_table(const fs::path& file) { return read_points(file, false); }

Landmarks name_landmarks(const fs::path& file, const LandmarkTable& table) {
  Landmarks landmarks;
  std::map<std::string, const LandmarkRow*> first;
  for (const auto& row : table.rows) {
    const std::string name = canonical_landmark(row.name);
    const auto [other, is_new] = first.try_emplace(name, &row);
    if (!is_new && other->second->point != row.point)
      throw InputError(file, row.where,
                       fmt::format("{} repeats the landmark {}, which {} has at another position; "
                                   "delete one of them",
                                   in_quotes(row.name), name, other->second->where));
    landmarks.points[name] = row.point;
  }
  return landmarks;
}

Landmarks read_landmarks(const fs::path& file) {
  return name_landmarks(file, read_landmark_table(file));
}

std::string landmarks_csv(const Landmarks& landmarks) {
  std::string text = "name,x_mm,y_mm,z_mm\n";
  for (const auto& [name, p] : landmarks.points)
    text += fmt::format("{},{},{},{}\n", name, p.x(), p.y(), p.z());
  return text;
}

}  // namespace condyle
