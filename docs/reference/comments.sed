# Comments of the C headers as Doxygen reads them: before a declaration or, on the same line, after it.
s,^/\* SPDX.*,,
t
s,^ */\* ---- .*\*/$,,
t
1,3s,^/\* ,/** @file\n * ,
s,^( *)/\* ,\1/** ,
s,([^ *].*) /\* ,\1 /**< ,
