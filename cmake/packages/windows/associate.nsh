  ; Sessions and recordings open in the window.
  WriteRegStr SHCTX "Software\Classes\C3DE.Session" "" "C3DE session or recording"
  WriteRegStr SHCTX "Software\Classes\C3DE.Session\DefaultIcon" "" "$INSTDIR\bin\c3de-window.exe,0"
  WriteRegStr SHCTX "Software\Classes\C3DE.Session\shell\open\command" "" '"$INSTDIR\bin\c3de-window.exe" "%1"'
  WriteRegStr SHCTX "Software\Classes\.c3de" "" "C3DE.Session"
  WriteRegStr SHCTX "Software\Classes\.c3dr" "" "C3DE.Session"
  System::Call 'shell32::SHChangeNotify(i 0x08000000, i 0, p 0, p 0)'
