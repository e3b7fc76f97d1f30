#include "render/window/input/input_steps.h"

#include <GLFW/glfw3.h>

#include <cmath>
#include <map>
#include <sstream>

#include "engine/core/error.h"
#include "engine/core/similar_word.h"

namespace condyle {
namespace {

using Kind = InputStep::Kind;

const std::map<std::string, Kind>& kinds() {
  static const std::map<std::string, Kind> known = {
      {"say", Kind::say},     {"click", Kind::click}, {"choose", Kind::choose},
      {"enter", Kind::enter}, {"drag", Kind::drag},   {"wheel", Kind::wheel},
      {"key", Kind::key},     {"wait", Kind::wait},   {"picture", Kind::picture}};
  return known;
}

std::string rest_of(std::istringstream& words) {
  std::string rest;
  std::getline(words >> std::ws, rest);
  while (!rest.empty() && (rest.back() == ' ' || rest.back() == '\r')) rest.pop_back();
  return rest;
}

bool names_an_item(Kind kind) {
  return kind != Kind::say && kind != Kind::key && kind != Kind::picture;
}

bool has_words(Kind kind) {
  return !names_an_item(kind) || kind == Kind::choose || kind == Kind::enter;
}

InputStep parse_step(const std::string& line) {
  std::istringstream words(line);
  std::string kind;
  words >> kind;
  const auto known = kinds().find(kind);
  if (known == kinds().end()) {
    std::vector<std::string> names;
    for (const auto& [name, value] : kinds()) names.push_back(name);
    throw InputError("\"" + kind + "\" is not a step" + suggestion(kind, names));
  }
  InputStep step{.kind = known->second};
  if (names_an_item(step.kind) && !(words >> step.item))
    throw InputError("\"" + kind + "\" needs the name of an item");
  bool has_numbers = true;
  if (step.kind == Kind::drag) has_numbers = bool(words >> step.right >> step.down);
  if (step.kind == Kind::wheel) has_numbers = bool(words >> step.down);
  if (!has_numbers)
    throw InputError("\"" + kind + "\" needs " +
                     (step.kind == Kind::drag ? "two numbers, pixels to the right and down"
                                              : "a number of clicks"));
  if (step.kind == Kind::wheel && (step.down != std::round(step.down) || std::abs(step.down) > 100))
    throw InputError("\"wheel\" needs a whole number of at most 100 clicks");
  step.words = rest_of(words);
  if (step.kind == Kind::picture && step.words.find('/') != std::string::npos)
    throw InputError("a picture has a name without a folder, not \"" + step.words + "\"");
  if (has_words(step.kind) && step.words.empty())
    throw InputError("\"" + kind + "\" needs words after it");
  if (!has_words(step.kind) && !step.words.empty())
    throw InputError("\"" + kind + "\" does not take \"" + step.words + "\"");
  if (step.kind == Kind::key) named_key(step.words);
  return step;
}

}  // namespace

std::vector<InputStep> parse_input_steps(const std::string& text, const std::string& name) {
  std::vector<InputStep> steps;
  std::istringstream lines(text);
  int number = 0;
  for (std::string line; std::getline(lines, line);) {
    ++number;
    const auto first = line.find_first_not_of(" \t\r");
    if (first == std::string::npos || line[first] == '#') continue;
    try {
      steps.push_back(parse_step(line));
    } catch (const InputError& error) {
      throw InputError(name + ", line " + std::to_string(number) + ": " + error.what());
    }
    steps.back().line = number;
  }
  return steps;
}

std::vector<unsigned> letters_of(const std::string& utf8) {
  std::vector<unsigned> letters;
  for (std::size_t i = 0; i < utf8.size();) {
    const auto first = static_cast<unsigned char>(utf8[i++]);
    const int length = first < 0x80   ? 1
                       : first < 0xc0 ? 0
                       : first < 0xe0 ? 2
                       : first < 0xf0 ? 3
                                      : 4;
    unsigned letter = length <= 1 ? first : first & (0x7fu >> length);
    bool whole = length > 0;
    for (int k = 1; k < length && whole; ++k) {
      whole = i < utf8.size() && (static_cast<unsigned char>(utf8[i]) & 0xc0) == 0x80;
      if (whole) letter = letter << 6 | (static_cast<unsigned char>(utf8[i++]) & 0x3f);
    }
    letters.push_back(whole && letter <= 0x10ffff ? letter : 0xfffd);
  }
  return letters;
}

NamedKey named_key(const std::string& name) {
  NamedKey named;
  std::string rest = name;
  for (bool more = true; more;) {
    more = false;
    for (auto& [prefix, held] : {std::pair<std::string, bool&>{"ctrl+", named.ctrl},
                                 std::pair<std::string, bool&>{"shift+", named.shift}})
      if (rest.starts_with(prefix)) {
        rest.erase(0, prefix.size());
        held = more = true;
      }
  }
  static const std::map<std::string, int> known = {
      {"Return", GLFW_KEY_ENTER}, {"Escape", GLFW_KEY_ESCAPE}, {"Tab", GLFW_KEY_TAB},
      {"space", GLFW_KEY_SPACE},  {"Delete", GLFW_KEY_DELETE}, {"Home", GLFW_KEY_HOME},
      {"Left", GLFW_KEY_LEFT},    {"Right", GLFW_KEY_RIGHT},   {"F1", GLFW_KEY_F1},
      {"F12", GLFW_KEY_F12}};
  if (const auto found = known.find(rest); found != known.end()) {
    named.key = found->second;
  } else if (rest.size() == 1 && rest[0] >= 'a' && rest[0] <= 'z') {
    named.key = GLFW_KEY_A + (rest[0] - 'a');
  } else if (rest.size() == 1 && rest[0] >= '0' && rest[0] <= '9') {
    named.key = GLFW_KEY_0 + (rest[0] - '0');
  } else {
    throw InputError("\"" + name + "\" is not a key; keys are called a, 5, Return, Escape, ctrl+z");
  }
  return named;
}

}  // namespace condyle
