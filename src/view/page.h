// The page of `ptexp view`: src/view/page.html, which the build makes a string of.
#pragma once

#include <string_view>

namespace pt {

/// NONCE stands in it where the word of its Content-Security-Policy belongs.
std::string_view page_html();

}  // namespace pt
