# Run when src/view/page.html or page.js changes: writes OUTPUT, page.cpp, with the text of PAGE, in
# which SCRIPT stands where that of SCRIPT belongs.
file(READ ${PAGE} page)
file(READ ${SCRIPT} script)
string(REPLACE "SCRIPT" "${script}" page "${page}")
file(WRITE ${OUTPUT} "#include \"view/view_site.h\"\n\nnamespace pt {\n\n"
     "std::string_view page_html() {\n  return R\"page(${page})page\";\n}\n\n}  // namespace pt\n")
