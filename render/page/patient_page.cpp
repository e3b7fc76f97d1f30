#include "render/page/patient_page.h"

#include <fmt/format.h>

#include <nlohmann/json.hpp>

#include "engine/core/html_text.h"
#include "render/page/page_files.h"

namespace condyle {
namespace {

using Json = nlohmann::ordered_json;

constexpr const char* controls = R"(<main>
<canvas id="view" tabindex="0" aria-label="The patient in 3-D: drag turns, the wheel zooms, the right button shifts"></canvas>
<div id="caption" class="motion"><span>Opening</span><span id="opening-now"></span><span id="phase"></span></div>
<div class="views"><button data-view="front">Front</button><button data-view="three-quarter">Three-quarter</button>
<button data-view="left">Left</button><button data-view="right">Right</button><button data-view="below">Below</button></div>
<p id="problem" hidden></p>
<noscript><p>The picture is drawn by a script of this page: allow scripts to see it.</p></noscript>
</main>
<div class="bar motion">
<button id="play">Play</button>
<label class="wide">Opening <input id="opening" type="range" min="0" value="0"></label>
<label class="wide">Motion <input id="time" type="range" min="0" value="0"> <output id="time-now"></output></label>
<label>Speed <select id="speed"><option value="0.25">slow, 1/4</option><option value="0.5">half</option>
<option value="1" selected>as simulated</option></select></label>
</div>
<div class="bar">
<label>Face <input id="face" type="range" min="0" max="1" step="0.01" title="From hidden to opaque"></label>
<label><input id="bones" type="checkbox" checked>Bones</label>
<label><input id="teeth" type="checkbox" checked>Teeth</label>
<label><input id="mouth" type="checkbox" checked>Gums and tongue</label>
</div>
)";

Json words_of(const PatientPage& page) {
  Json words = {{"face_opacity", page.face_opacity},
                {"times_s", page.times_s},
                {"opening_mm", page.opening_mm},
                {"phases", Json::array()}};
  for (const PatientPage::Phase& phase : page.phases)
    words["phases"].push_back(
        {{"name", phase.name}, {"start_s", phase.start_s}, {"end_s", phase.end_s}});
  return words;
}

}  // namespace

std::string patient_page(const PatientPage& page) {
  std::string html = fmt::format(
      "<!DOCTYPE html>\n<html lang=\"en\">\n<head>\n<meta charset=\"utf-8\">\n"
      "<meta name=\"viewport\" content=\"width=device-width, initial-scale=1\">\n"
      "<meta http-equiv=\"Content-Security-Policy\" content=\"default-src 'none'; "
      "style-src 'unsafe-inline'; script-src 'unsafe-inline'\">\n"
      "<title>{0}</title>\n<style>\n{1}</style>\n</head>\n<body>\n<header>\n<h1>{0}</h1>\n",
      escaped(page.title), viewer_style);
  if (!page.subtitle.empty()) html += "<p>" + escaped(page.subtitle) + "</p>\n";
  html += "</header>\n";
  html += controls;
  html += fmt::format(
      "<footer><strong>For research and education, not for clinical use.</strong> Made by {} on "
      "{}.",
      escaped(page.program), escaped(page.date));
  for (const auto& [what, hash] : page.hashes)
    html += fmt::format(" {} {}.", escaped(what), escaped(hash));
  html += " Drag to turn, wheel to zoom, right button to shift, space to play.</footer>\n";
  html += "<script type=\"application/json\" id=\"words\">" +
          json_for_script(words_of(page).dump(-1, ' ', false, Json::error_handler_t::replace)) +
          "</script>\n<script type=\"application/octet-stream;base64\" id=\"glb\">" +
          base64(page.glb) + "</script>\n<script>\n";
  html += viewer_script;
  html += "</script>\n</body>\n</html>\n";
  return html;
}

}  // namespace condyle
