# Run by cpack before it makes a .deb: what Debian has elsewhere than `cmake --install`.
set(usr ${CPACK_TEMPORARY_INSTALL_DIRECTORY}/program/usr)
file(RPATH_REMOVE FILE ${usr}/bin/ptexp)  # libraries are the system's
file(COPY_FILE ${usr}/share/doc/ptexp/LICENSE ${usr}/share/doc/ptexp/copyright)
file(REMOVE ${usr}/share/doc/ptexp/LICENSE)
file(MAKE_DIRECTORY ${usr}/share/zsh/vendor-completions)
file(RENAME ${usr}/share/zsh/site-functions/_ptexp ${usr}/share/zsh/vendor-completions/_ptexp)
file(REMOVE_RECURSE ${usr}/share/zsh/site-functions)
execute_process(COMMAND gzip --best --no-name --force ${usr}/share/man/man1/ptexp.1
                COMMAND_ERROR_IS_FATAL ANY)
