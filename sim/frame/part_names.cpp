#include "sim/frame/part_names.h"

#include <cctype>
#include <string_view>

namespace condyle {
namespace {

/// Whether a word ends at this position: at punctuation or a space, not within a path or file name.
bool ends_word(std::string_view sentence, std::size_t at) {
  constexpr std::string_view signs = " ,;:)\"'?!";
  if (at >= sentence.size() || signs.find(sentence[at]) != std::string_view::npos) return true;
  return sentence[at] == '.' && (at + 1 == sentence.size() || sentence[at + 1] == ' ');
}

bool begins_word(std::string_view sentence, std::size_t at) {
  constexpr std::string_view signs = " (\"'";
  return at == 0 || signs.find(sentence[at - 1]) != std::string_view::npos;
}

}  // namespace

std::string readable_name(std::string name) {
  if (name == "ans") return "ANS";
  if (name == "pns") return "PNS";
  for (char& c : name)
    if (c == '_' || c == '-') c = ' ';
  return name;
}

std::string display_name(const std::string& name) {
  std::string words = readable_name(name);
  if (!words.empty())
    words[0] = static_cast<char>(std::toupper(static_cast<unsigned char>(words[0])));
  return words;
}

std::string with_readable_names(std::string sentence, std::span<const std::string> names) {
  for (const std::string& name : names) {
    if (name.find_first_of("_-") == std::string::npos) continue;
    for (auto at = sentence.find(name); at != std::string::npos; at = sentence.find(name, at + 1))
      if (begins_word(sentence, at) && ends_word(sentence, at + name.size()))
        sentence.replace(at, name.size(), readable_name(name));
  }
  return sentence;
}

}  // namespace condyle
