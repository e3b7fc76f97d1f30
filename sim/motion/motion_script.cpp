#include "sim/motion/motion_script.h"

#include <fmt/format.h>

#include <algorithm>
#include <cctype>
#include <charconv>
#include <cmath>
#include <map>

#include "engine/core/error.h"
#include "sim/muscles/expression_names.h"

namespace condyle {
namespace {

constexpr std::size_t max_statements = 10000;

/// Unit and range of a verb's number.
struct VerbRule {
  Verb verb;
  const char* unit;
  double low, high;
};

const std::map<std::string, VerbRule>& verbs() {
  static const std::map<std::string, VerbRule> rules = {
      {"open", {Verb::open, "mm", 0.5, 80}},          {"close", {Verb::close, "", 0, 0}},
      {"hinge", {Verb::hinge, "deg", 0.5, 30}},       {"protrude", {Verb::protrude, "mm", 0.2, 20}},
      {"retrude", {Verb::retrude, "mm", 0.05, 3}},    {"left", {Verb::left, "mm", 0.2, 20}},
      {"right", {Verb::right, "mm", 0.2, 20}},        {"rest", {Verb::rest, "mm", 0.2, 15}},
      {"hold", {Verb::hold, "s", 0, 3600}},           {"posselt", {Verb::posselt, "", 0, 0}},
      {"chew", {Verb::chew_left, "cycles", 1, 1000}},
  };
  return rules;
}

std::string lower(std::string text) {
  std::transform(text.begin(), text.end(), text.begin(),
                 [](unsigned char c) { return static_cast<char>(std::tolower(c)); });
  return text;
}

std::optional<double> number_of(const std::string& word) {
  std::string digits = word.starts_with('+') ? word.substr(1) : word;
  double value = 0;
  const auto [end, error] = std::from_chars(digits.data(), digits.data() + digits.size(), value);
  if (error != std::errc{} || end != digits.data() + digits.size() || !std::isfinite(value))
    return std::nullopt;
  return value;
}

std::string list_of_verbs() {
  std::string names;
  for (const auto& [name, rule] : verbs()) names += name + ", ";
  return names + "blink, neutral, set, or an expression (" + list_expressions() + ")";
}

bool is_expression(const std::string& word) {
  return word == "neutral" || word == "blink" || find_expression(word);
}

bool is_number(const std::string& text) {
  return !text.empty() && (std::isdigit(static_cast<unsigned char>(text[0])) || text[0] == '-' ||
                           text[0] == '+' || text[0] == '.');
}

/// Reads the words of one statement from left to right.
class Reader {
 public:
  Reader(std::vector<std::string> words, int line, const std::string& source)
      : words_(std::move(words)), line_(line), source_(source) {}

  bool done() const { return next_ == words_.size(); }
  const std::string& peek() const { return words_[next_]; }
  std::string take() { return words_[next_++]; }
  std::string where() const { return fmt::format("line {}, {}", line_, words_.front()); }

  /// throws: InputError about the word taken last.
  [[noreturn]] void refuse(const std::string& problem) const {
    const std::string word = next_ > 0 ? words_[next_ - 1] : "";
    throw InputError(
        source_, fmt::format("line {}, word {} \"{}\"", line_, next_, word.substr(0, 40)), problem);
  }

  /// The next word as a number, with an optional unit.
  double number(const std::string& what, const char* unit, double low, double high) {
    if (done()) refuse(fmt::format("must be followed by {}", what));
    const std::string word = take();
    // The unit may be attached to the number: 40mm.
    std::size_t split = word.size();
    while (split > 0 && !std::isdigit(static_cast<unsigned char>(word[split - 1])) &&
           word[split - 1] != '.')
      --split;
    const auto value = number_of(split > 0 ? word.substr(0, split) : word);
    if (!value) refuse(fmt::format("is not a number; expected {}", what));
    if (split < word.size()) check_unit(word.substr(split), unit);
    if (!(*value >= low && *value <= high))
      refuse(fmt::format("is out of range: {} must be {} to {}{}{}", what, low, high,
                         *unit ? " " : "", unit));
    if (!done() && split == word.size() && is_unit(peek())) check_unit(take(), unit);
    return *value;
  }

 private:
  static bool is_unit(const std::string& word) {
    static const std::vector<std::string> units = {
        "mm", "cm",     "m",     "s",   "ms",      "deg",    "degrees", "mm/s",
        "hz", "cycles", "cycle", "sec", "seconds", "degree", "inch"};
    return std::find(units.begin(), units.end(), word) != units.end();
  }
  void check_unit(const std::string& word, const std::string& unit) const {
    const std::map<std::string, std::string> same = {
        {"degrees", "deg"}, {"degree", "deg"}, {"sec", "s"}, {"seconds", "s"}, {"cycle", "cycles"}};
    const auto other = same.find(word);
    if ((other == same.end() ? word : other->second) != unit)
      refuse(unit.empty() ? "is a unit where a plain number is expected"
                          : fmt::format("is a unit, but {} is expected", unit));
  }

  std::vector<std::string> words_;
  std::size_t next_ = 0;
  int line_;
  const std::string& source_;
};

/// One expression with its strength and side; `word` is its name.
FaceChange read_face_change(Reader& reader, const std::string& word) {
  FaceChange change;
  change.momentary = word == "blink";
  if (word != "neutral") {
    change.expression = find_expression(change.momentary ? "AU45" : word)->name;
    if (!reader.done() && is_number(reader.peek()))
      change.strength = reader.number("strength", "", 0, 1);
  }
  if (!reader.done() && (reader.peek() == "left" || reader.peek() == "right")) {
    const bool left = reader.take() == "left";
    change.left = left;
    change.right = !left;
  }
  return change;
}

/// Expressions joined by "and"; `word` is the first one's name. Returns the movement of the jaw
/// that follows a last "and"; empty: none.
std::string read_face(Reader& reader, std::string word, Statement& statement) {
  for (;;) {
    if (!statement.face.empty() && (word == "blink" || statement.face.front().momentary))
      reader.refuse("a blink may be joined with a movement of the jaw only");
    statement.face.push_back(read_face_change(reader, word));
    const bool blinks = statement.face.front().momentary;
    if (reader.done()) return "";
    word = reader.take();
    if (word == "over" && blinks) reader.refuse("a blink takes no duration");
    if (word == "over") {
      statement.face_duration_s = reader.number("over", "s", 0.05, 3600);
      if (reader.done()) return "";
      word = reader.take();
    }
    if (word != "and")
      reader.refuse(
          blinks ? "is not understood; a strength of 0 to 1 may be followed by left or right, and "
                   "a movement of the jaw after \"and\""
                 : "is not understood; a strength of 0 to 1 may be followed by left or right, over "
                   "(s), and another expression or movement after \"and\"");
    if (reader.done()) reader.refuse("must be followed by an expression or a movement");
    word = reader.take();
    if (is_expression(word)) continue;
    if (!verbs().contains(word))
      reader.refuse("is neither an expression nor a movement; valid ones are " + list_of_verbs());
    return word;
  }
}

/// Expressions after the movement of a jaw.
void read_face_after_jaw(Reader& reader, Statement& statement) {
  const std::string word = reader.done() ? "" : reader.take();
  if (!is_expression(word) || !statement.face.empty())
    reader.refuse(
        "is not the name of an expression; one movement of the jaw may be joined with "
        "expressions (" +
        list_expressions() + ") by \"and\"");
  if (!read_face(reader, word, statement).empty())
    reader.refuse("is a second movement of the jaw at the same time");
}

void read_movement(Reader& reader, const std::string& word, const VerbRule& rule,
                   Statement& statement) {
  statement.verb = rule.verb;
  const bool chews = word == "chew";
  if (chews) {
    if (reader.done()) reader.refuse("must be followed by left or right");
    const std::string side = reader.take();
    if (side != "left" && side != "right") reader.refuse("must be left or right");
    statement.verb = side == "left" ? Verb::chew_left : Verb::chew_right;
  }
  if (!reader.done() && is_number(reader.peek())) {
    if (!*rule.unit) {
      reader.take();
      reader.refuse(word + " takes no number");
    }
    statement.amount = reader.number(word, rule.unit, rule.low, rule.high);
  }
  if (rule.verb == Verb::hold && !statement.amount) reader.refuse("must be followed by seconds");
  if (rule.verb == Verb::hinge && !statement.amount) reader.refuse("must be followed by degrees");
  while (!reader.done()) {
    const std::string option = reader.take();
    if (option == "and")
      read_face_after_jaw(reader, statement);
    else if (option == "over" && rule.verb != Verb::hold)
      statement.duration_s = reader.number("over", "s", 0.05, 3600);
    else if (option == "at" && rule.verb != Verb::hold && !chews)
      statement.speed_mm_s = reader.number("at", "mm/s", 1, 600);
    else if (option == "rate" && chews)
      statement.rate_hz = reader.number("rate", "hz", 0.2, 4);
    else if (option == "size" && chews)
      statement.size_mm = reader.number("size", "mm", 2, 40);
    else if (option == "width" && chews)
      statement.width_mm = reader.number("width", "mm", 0, 15);
    else if (*rule.unit && !statement.amount && !statement.duration_s && !statement.speed_mm_s)
      reader.refuse(fmt::format("is neither a number of {} to {} nor one of its options ({})",
                                rule.unit, word, chews ? "rate, size, width, over" : "over, at"));
    else
      reader.refuse(chews ? "is not understood; the number of cycles may be followed by rate, "
                            "size, width or over"
                    : rule.verb == Verb::hold
                        ? std::string("is not understood; hold takes seconds only")
                        : std::string("is not understood; the amount may be followed by over "
                                      "(s) or at (mm/s)"));
  }
}

/// A statement whose first word, `word`, was taken.
Statement read_statement(Reader& reader, std::string word) {
  Statement statement{.verb = Verb::face, .where = reader.where()};
  if (is_expression(word)) word = read_face(reader, word, statement);
  if (word.empty()) return statement;
  const auto rule = verbs().find(word);
  if (rule == verbs().end()) reader.refuse("is not a movement; valid ones are " + list_of_verbs());
  read_movement(reader, word, rule->second, statement);
  return statement;
}

void read_setting(Reader& reader, MotionParameters& parameters) {
  if (reader.done()) reader.refuse("must be followed by a parameter and its value");
  std::string name = reader.take();
  std::replace(name.begin(), name.end(), '-', '_');
  const auto* entry = motion_parameter(name);
  if (!entry) {
    std::string known;
    for (const auto& parameter : motion_parameter_names())
      known += (known.empty() ? "" : ", ") + parameter.name;
    reader.refuse("is not a motion parameter; valid ones are " + known);
  }
  const std::string unit = entry->unit == "mm_s" ? "mm/s" : entry->unit;
  const double value = reader.number(entry->name, unit.c_str(), entry->low, entry->high);
  if (!reader.done()) {
    reader.take();
    reader.refuse("is one word too many");
  }
  for (const auto member : entry->values) parameters.*member = value;
}

/// The first word, in lower case.
std::string first_word(const std::string& text) {
  const auto start = text.find_first_not_of(" \t\r\n;");
  if (start == std::string::npos) return {};
  const auto end = text.find_first_of(" \t\r\n;#", start);
  return lower(text.substr(start, end == std::string::npos ? end : end - start));
}

}  // namespace

bool is_motion_script(const std::string& text) {
  const std::string word = first_word(text);
  const bool verb = verbs().contains(word) || word == "set" || is_expression(word);
  return verb || text.find(';') != std::string::npos || text.find('\n') != std::string::npos;
}

MotionScript parse_motion_script(const std::string& text, const std::string& source) {
  MotionScript script;
  int line = 1;
  std::vector<std::string> words;
  std::string word;
  bool comment = false;
  const auto end_word = [&] {
    if (!word.empty()) words.push_back(lower(word));
    word.clear();
  };
  const auto end_statement = [&] {
    end_word();
    if (words.empty()) return;
    Reader reader(std::move(words), line, source);
    words.clear();
    const std::string verb = reader.take();
    if (verb == "set") {
      if (!script.statements.empty()) reader.refuse("must come before the first movement");
      read_setting(reader, script.parameters);
      return;
    }
    if (script.statements.size() == max_statements)
      reader.refuse(fmt::format("exceeds the limit of {} movements", max_statements));
    script.statements.push_back(read_statement(reader, verb));
  };
  for (std::size_t i = 0; i <= text.size(); ++i) {
    const char c = i < text.size() ? text[i] : '\n';
    if (c == '\n' || (c == ';' && !comment)) {
      end_statement();
      if (c == '\n') {
        ++line;
        comment = false;
      }
    } else if (comment) {
      continue;
    } else if (c == '#') {
      end_word();
      comment = true;
    } else if (std::isspace(static_cast<unsigned char>(c)) || c == ',') {
      end_word();
    } else {
      word += c;
    }
  }
  if (script.statements.empty())
    throw InputError(source, "", "contains no movement; write e.g. open 40; close; protrude 6");
  return script;
}

}  // namespace condyle
