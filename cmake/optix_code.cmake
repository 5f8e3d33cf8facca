# Writes OUTPUT, a C++ string literal, from the PTX file INPUT. Its version is lowered to one that the
# drivers know whose OptiX is asked for: the code for compute capability 7.5 needs no later one but for
# hints that say which bytes of a load are used.
file(READ ${INPUT} text)
string(REGEX REPLACE "\n\\.version [0-9.]+" "\n.version 7.8" text "${text}")
string(REGEX REPLACE "\n[\t ]*\\.pragma \"used_bytes_mask [0-9]+\";" "" text "${text}")
string(REGEX REPLACE "//[^\n]*\n" "\n" text "${text}")
string(REGEX REPLACE "\n[\n\t ]*\n" "\n" text "${text}")
file(WRITE ${OUTPUT} "R\"PTX(${text})PTX\"\n")
