# Writes OUTPUT, bytes as C++ lists them, from the PTX file INPUT, by gzip. The PTX's version is lowered
# to one that the drivers know whose OptiX is asked for: the code for compute capability 7.5 needs no
# later one but for hints that say which bytes of a load are used.
file(READ ${INPUT} text)
string(REGEX REPLACE "\n\\.version [0-9.]+" "\n.version 7.8" text "${text}")
string(REGEX REPLACE "\n[\t ]*\\.pragma \"used_bytes_mask [0-9]+\";" "" text "${text}")
string(REGEX REPLACE "//[^\n]*\n" "\n" text "${text}")
string(REGEX REPLACE "\n[\n\t ]*\n" "\n" text "${text}")
file(WRITE ${OUTPUT}.ptx "${text}")
file(ARCHIVE_CREATE OUTPUT ${OUTPUT}.gz PATHS ${OUTPUT}.ptx FORMAT raw
     COMPRESSION GZip COMPRESSION_LEVEL 9)
file(READ ${OUTPUT}.gz bytes HEX)
# Without the time; ^ would match again behind each match.
string(SUBSTRING "${bytes}" 0 8 head)
string(SUBSTRING "${bytes}" 16 -1 tail)
set(bytes "${head}00000000${tail}")
string(REGEX REPLACE "(..)" "0x\\1," bytes "${bytes}")
string(REPEAT "." 80 line)
string(REGEX REPLACE "(${line})" "\\1\n" bytes "${bytes}")
file(WRITE ${OUTPUT} "${bytes}\n")
