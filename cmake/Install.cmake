# `cmake --install BUILD --prefix DIR` makes a folder that runs on another Linux machine with the
# same or a newer glibc and libstdc++: bin/ptexp, and in lib/ the shared libraries that it needs,
# their own dependencies included; in share/ the man page, completions and licence. `--component
# tests` adds bin/ptexp_tests, for a machine that has a GPU but no compiler. Package.cmake leaves
# out lib/, the component `libraries`.

# The system's own, and the driver's, which must match the machine's kernel module.
set(PTEXP_SYSTEM_LIBRARIES
    "^ld-linux.*" "^linux-vdso.*" "^lib(c|m|dl|rt|pthread|resolv)\\.so.*" "^libstdc\\+\\+\\.so.*"
    "^libgcc_s\\.so.*" "^libcuda\\.so.*" "^libnvidia-.*")

# install_relocatable(TARGET PROGRAMS LIBRARIES [install arguments]): the program and its libraries,
# in components of these names.
# DT_RPATH rather than DT_RUNPATH, because only the former is searched for the libraries' own
# dependencies as well; so the copied libraries stay as they are.
function(install_relocatable target programs libraries)
  target_link_options(${target} PRIVATE LINKER:--disable-new-dtags)
  set_target_properties(${target} PROPERTIES INSTALL_RPATH "$ORIGIN/../lib")
  install(TARGETS ${target} RUNTIME_DEPENDENCY_SET ${target}_libraries
          RUNTIME DESTINATION bin COMPONENT ${programs} ${ARGN})
  install(RUNTIME_DEPENDENCY_SET ${target}_libraries
          PRE_EXCLUDE_REGEXES ${PTEXP_SYSTEM_LIBRARIES}
          LIBRARY DESTINATION lib COMPONENT ${libraries} ${ARGN})
endfunction()

# install_printed(NAME DESTINATION OPTION...): what ptexp prints with these options, asked when it is
# installed, so that the build need not.
function(install_printed name destination)
  list(JOIN ARGN " " options)
  set(file "${CMAKE_CURRENT_BINARY_DIR}/printed/${name}")
  install(CODE "
    file(MAKE_DIRECTORY \"${CMAKE_CURRENT_BINARY_DIR}/printed\")
    set(ENV{PTEXP_LAUNCHER} off)
    execute_process(COMMAND \"$<TARGET_FILE:ptexp>\" ${options} OUTPUT_FILE \"${file}\"
                    COMMAND_ERROR_IS_FATAL ANY)"
    COMPONENT program)
  install(FILES ${file} DESTINATION ${destination} COMPONENT program)
endfunction()

install_relocatable(ptexp program libraries)
install(FILES ${PROJECT_SOURCE_DIR}/LICENSE ${PROJECT_SOURCE_DIR}/README.md
              ${PROJECT_SOURCE_DIR}/CITATION.cff
        DESTINATION share/doc/ptexp COMPONENT program)
install(FILES ${PROJECT_SOURCE_DIR}/data/sunsky/LICENSE DESTINATION share/doc/ptexp/sunsky
        COMPONENT program)
install_printed(ptexp.1 share/man/man1 --reference man)
install_printed(ptexp share/bash-completion/completions --completion bash)
install_printed(_ptexp share/zsh/site-functions --completion zsh)
install_printed(ptexp.fish share/fish/vendor_completions.d --completion fish)
if(TARGET ptexp_tests)
  install_relocatable(ptexp_tests tests tests EXCLUDE_FROM_ALL)
endif()
