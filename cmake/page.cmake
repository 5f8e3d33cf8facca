# Run when src/view/view_site.html changes: writes OUTPUT, page.cpp, with the text of PAGE.
file(READ ${PAGE} page)
file(WRITE ${OUTPUT} "#include \"view/view_site.h\"\n\nnamespace pt {\n\n"
     "std::string_view page_html() {\n  return R\"page(${page})page\";\n}\n\n}  // namespace pt\n")
