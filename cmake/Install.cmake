# `cmake --install BUILD --prefix DIR` makes a folder that runs on another Linux machine with the
# same or a newer glibc and libstdc++: bin/ptexp, and in lib/ the shared libraries that it needs,
# their own dependencies included. `--component tests` adds bin/ptexp_tests, for a machine that has
# a GPU but no compiler.

# The system's own, and the driver's, which must match the machine's kernel module.
set(PTEXP_SYSTEM_LIBRARIES
    "^ld-linux.*" "^linux-vdso.*" "^lib(c|m|dl|rt|pthread|resolv)\\.so.*" "^libstdc\\+\\+\\.so.*"
    "^libgcc_s\\.so.*" "^libcuda\\.so.*" "^libnvidia-.*")

# install_relocatable(TARGET [install arguments]): the program and its libraries.
# DT_RPATH rather than DT_RUNPATH, because only the former is searched for the libraries' own
# dependencies as well; so the copied libraries stay as they are.
function(install_relocatable target)
  target_link_options(${target} PRIVATE LINKER:--disable-new-dtags)
  set_target_properties(${target} PROPERTIES INSTALL_RPATH "$ORIGIN/../lib")
  install(TARGETS ${target} RUNTIME_DEPENDENCY_SET ${target}_libraries
          RUNTIME DESTINATION bin ${ARGN})
  install(RUNTIME_DEPENDENCY_SET ${target}_libraries
          PRE_EXCLUDE_REGEXES ${PTEXP_SYSTEM_LIBRARIES}
          LIBRARY DESTINATION lib ${ARGN})
endfunction()

install_relocatable(ptexp)
install(FILES ${PROJECT_SOURCE_DIR}/LICENSE DESTINATION share/doc/ptexp)
if(TARGET ptexp_tests)
  install_relocatable(ptexp_tests COMPONENT tests EXCLUDE_FROM_ALL)
endif()
