#include "render/recording/caption.h"

#include <fmt/format.h>

#include <algorithm>
#include <map>

#include "engine/core/error.h"

namespace condyle {

std::vector<std::string> caption_lines(const std::string& caption, int frame,
                                       const FrameState& state, const std::string& motion) {
  if (caption.empty()) return {};
  const auto number = [](double value, int digits) {
    std::string text = fmt::format("{:.{}f}", value, digits);
    // Avoids an opening of "-0.0" at rest.
    return text.find_first_not_of("-0.") == std::string::npos && text[0] == '-' ? text.substr(1)
                                                                                : text;
  };
  const std::map<std::string, std::string> values = {
      {"time", number(state.time_s, 2)},
      {"opening", number(state.measures.opening_mm, 1)},
      {"interincisal", number(state.measures.interincisal_mm, 1)},
      {"rotation", number(state.measures.rotation_deg, 1)},
      {"frame", std::to_string(frame)},
      {"motion", motion}};
  std::vector<std::string> lines(1);
  for (std::size_t i = 0; i < caption.size(); ++i) {
    if (caption[i] == '|') {
      lines.emplace_back();
    } else if (caption[i] == '{') {
      const auto end = caption.find('}', i);
      const std::string name = caption.substr(i + 1, std::min(end, caption.size()) - i - 1);
      const auto value = values.find(name);
      if (end == std::string::npos || value == values.end())
        throw InputError("--caption " + caption + ": {" + name +
                         "} is unknown; valid are {time}, {opening}, {interincisal}, {rotation}, "
                         "{frame} and {motion}");
      lines.back() += value->second;
      i = end;
    } else {
      lines.back() += caption[i];
    }
  }
  return lines;
}

}  // namespace condyle
