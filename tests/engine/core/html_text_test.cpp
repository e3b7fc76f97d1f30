#include "engine/core/html_text.h"

#include <gtest/gtest.h>

namespace condyle {

TEST(HtmlText, NoTextBecomesMarkup) {
  EXPECT_EQ(escaped("<b a=\"1\">&'</b>"), "&lt;b a=&quot;1&quot;&gt;&amp;&#39;&lt;/b&gt;");
  EXPECT_EQ(json_for_script("{\"a\":\"</script><!--\"}"), "{\"a\":\"\\u003c/script>\\u003c!--\"}");
}

// Test vectors of RFC 4648, and bytes beyond ASCII.
TEST(HtmlText, Base64IsThatOfTheStandard) {
  const char* const pairs[][2] = {{"", ""},
                                  {"f", "Zg=="},
                                  {"fo", "Zm8="},
                                  {"foo", "Zm9v"},
                                  {"foob", "Zm9vYg=="},
                                  {"fooba", "Zm9vYmE="},
                                  {"foobar", "Zm9vYmFy"},
                                  {"\xff\xfe\xfd", "//79"}};
  for (const auto& [bytes, text] : pairs) EXPECT_EQ(base64(bytes), text) << bytes;
}

}  // namespace condyle
