# Makes a C source that holds a file's bytes and a zero byte behind them:
#
#   cmake -DFILE=standard.csv -DNAME=accuracy_standard_csv -DHEADER=acquire/cli/accuracy/standard.h -DOUTPUT=standard.c -P EmbedFile.cmake
#
# Bytes rather than a string: C11 promises no string longer than 4095.
file(READ ${FILE} bytes HEX)
string(REGEX REPLACE "(................................)" "\\1\n" bytes "${bytes}")
string(REGEX REPLACE "([0-9a-f][0-9a-f])" "0x\\1," bytes "${bytes}")
file(WRITE ${OUTPUT} "#include \"${HEADER}\"\n\nconst unsigned char ${NAME}[] = {\n${bytes}0};\n")
