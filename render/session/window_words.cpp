#include "render/session/window_words.h"

#include <algorithm>
#include <array>
#include <regex>
#include <string_view>

namespace condyle {
namespace {

struct Phrase {
  std::string_view there, here;
};
constexpr std::array phrases = {
    Phrase{"did you mean --units ", "choose as the unit of lengths "},
    Phrase{"did you mean --frame ", "choose as the directions of the axes "},
    Phrase{"with --units ", "with the unit of lengths "},
    Phrase{"with --frame ", "with the directions of the axes "},
    Phrase{"--units", "the unit of lengths"},
    Phrase{"--frame", "the directions of the axes"},
    Phrase{"no bone is given; name one with --skull, --maxilla or --mandible",
           "no surface is a bone; choose skull, maxilla or mandible for one of them"},
    Phrase{"make a case from surfaces with: condyle import meshes --mandible FILE --maxilla FILE "
           "... --out FOLDER",
           "open or drop its surfaces to make one"},
    Phrase{"make one from surfaces with: condyle import meshes --mandible FILE --maxilla FILE ... "
           "--out FOLDER",
           "open or drop its surfaces to make one"},
    Phrase{"move it out, or import it again with --push-out", "move it out by hand (key M)"},
    Phrase{"import it again with --push-out", "move it by hand (key M)"},
    Phrase{", --push-out moves it out", "; move it out by hand (key M)"},
    Phrase{"(--attach, or \"attachments\" in case.json)", "(\"attachments\" in case.json)"},
    Phrase{"; give the same options, another --out, or omit --resume", "; choose another folder"},
    Phrase{"continue with --resume", "resume the recording"}};

}  // namespace

std::string in_window_words(std::string sentence) {
  for (const auto& [there, here] : phrases)
    if (const auto at = sentence.find(there); at != std::string::npos) {
      sentence.replace(at, there.size(), here);
      if (here.starts_with("choose") && sentence.ends_with("?")) sentence.back() = '.';
    }
  // The window has no such choice.
  static const std::regex carrier("; --carrier-of \\S+ would change that");
  sentence = std::regex_replace(sentence, carrier, "");
  // Other options are reduced to their names; in a path two hyphens follow no space.
  static const std::regex option("(^|[ (])--([a-z][a-z-]*)(?=[ ,;:)]|\\.( |$)|$)");
  sentence = std::regex_replace(sentence, option, "$1$2");
  static const std::regex degrees("([0-9]) deg(rees?)?(?=[ ,;:)]|/mm|\\.( |$)|$)");
  sentence = std::regex_replace(sentence, degrees, "$1\u00b0");
  static const std::regex volume("\\bcm3\\b");
  return std::regex_replace(sentence, volume, "cm\u00b3");
}

}  // namespace condyle
