  ; What another program has taken over stays.
  ReadRegStr $0 SHCTX "Software\Classes\.c3de" ""
  StrCmp $0 "C3DE.Session" 0 +2
  DeleteRegKey SHCTX "Software\Classes\.c3de"
  ReadRegStr $0 SHCTX "Software\Classes\.c3dr" ""
  StrCmp $0 "C3DE.Session" 0 +2
  DeleteRegKey SHCTX "Software\Classes\.c3dr"
  DeleteRegKey SHCTX "Software\Classes\C3DE.Session"
  System::Call 'shell32::SHChangeNotify(i 0x08000000, i 0, p 0, p 0)'
