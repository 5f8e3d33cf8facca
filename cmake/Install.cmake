# `cmake --install` makes a folder that can be copied to another Linux machine: bin/, lib/ with the
# shared libraries that are not part of every system, and $ORIGIN run paths.
include(GNUInstallDirs)
set_target_properties(ptexp PROPERTIES INSTALL_RPATH "$ORIGIN/../lib")
install(TARGETS ptexp RUNTIME DESTINATION bin)
