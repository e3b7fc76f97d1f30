#include "sim/report/page_parts.h"

#include "engine/core/html_text.h"
#include "sim/report/plots.h"

namespace condyle {
namespace {

const char* const style = R"(<style>
body { font: 15px/1.45 sans-serif; color: #222; background: #fff; max-width: 1080px; margin: 24px auto; padding: 0 16px; }
h1 { font-size: 24px; margin: 0 0 4px; } h2 { font-size: 18px; margin: 28px 0 8px; } h3 { font-size: 15px; margin: 18px 0 6px; }
.verdict { border: 2px solid #222; border-radius: 6px; padding: 12px 16px; margin: 16px 0; font-size: 18px; }
.bad { border-color: #b2182b; } .good { border-color: #2166ac; }
.bad strong, td.bad { color: #b2182b; } .good strong { color: #2166ac; }
table { border-collapse: collapse; width: 100%; font-size: 14px; }
th, td { border-bottom: 1px solid #ccc; padding: 6px 8px; text-align: left; vertical-align: top; }
th { border-bottom: 2px solid #888; } td.bad { font-weight: bold; }
ol.worst > li { margin: 8px 0; }
figure { margin: 16px 0; } img, svg { max-width: 100%; height: auto; } figcaption { color: #444; font-size: 14px; }
.small { color: #555; font-size: 13px; } li { margin: 2px 0; }
@media print {
  @page { size: A4; margin: 14mm 14mm 16mm;
    @bottom-left { content: "For research and education, not for clinical use"; font: 8pt sans-serif; color: #666; }
    @bottom-right { content: counter(page) " / " counter(pages); font: 8pt sans-serif; color: #666; } }
  body { font-size: 9.5pt; max-width: none; margin: 0; padding: 0; }
  h1 { font-size: 17pt; } h2 { font-size: 12.5pt; margin: 14pt 0 4pt; } h3 { font-size: 10.5pt; margin: 10pt 0 3pt; }
  table { font-size: 8.5pt; } th, td { padding: 2pt 5pt; } .small, figcaption { font-size: 8pt; }
  .verdict { padding: 6pt 10pt; margin: 6pt 0; font-size: 11pt; }
  figure { margin: 6pt 0; } img { max-height: 205mm; } img.wide { max-height: 128mm; }
  figure, tr, li, .verdict, table.short { break-inside: avoid; } h2, h3, thead { break-after: avoid; }
  .verdict, th, td { print-color-adjust: exact; }
}
</style>
)";

}  // namespace

PageWriter::PageWriter(const std::string& title)
    : html_(
          "<!DOCTYPE html>\n<html lang=\"en\">\n<head>\n<meta charset=\"utf-8\">\n"
          "<meta name=\"viewport\" content=\"width=device-width\">\n<title>" +
          escaped(title) + "</title>\n" + style + "</head>\n<body>\n") {}

PageWriter& PageWriter::operator+=(std::string_view html) {
  html_ += html;
  return *this;
}

void PageWriter::add_notes(const std::vector<std::string>& notes) {
  for (const auto& note : notes) add("<li>{}</li>\n", escaped(note));
}

std::string PageWriter::finish() {
  html_ +=
      "<p class=\"small\">For research and education, not for clinical "
      "use.</p>\n</body>\n</html>\n";
  return std::exchange(html_, {});
}

}  // namespace condyle
