# SPDX-License-Identifier: Apache-2.0
# What a person and a window manager do to a window: keys, another size, something over it, minimising. By Xlib alone.
import ctypes
import ctypes.util
import subprocess
import re
import time

NORMAL, ICONIC = 1, 3  # WM_STATE
KEY_PRESS, KEY_RELEASE = 2, 3
KEY_PRESS_MASK, KEY_RELEASE_MASK = 1, 2


class KeyEvent(ctypes.Structure):
    """XKeyEvent; Xlib sends as much as its largest event has."""
    _fields_ = [("type", ctypes.c_int), ("serial", ctypes.c_ulong), ("send_event", ctypes.c_int), ("display", ctypes.c_void_p),
                ("window", ctypes.c_ulong), ("root", ctypes.c_ulong), ("subwindow", ctypes.c_ulong), ("time", ctypes.c_ulong),
                ("x", ctypes.c_int), ("y", ctypes.c_int), ("x_root", ctypes.c_int), ("y_root", ctypes.c_int),
                ("state", ctypes.c_uint), ("keycode", ctypes.c_uint), ("same_screen", ctypes.c_int), ("pad", ctypes.c_long * 24)]


class XWindow:
    """The window whose title begins so, on this display."""

    def __init__(self, display, title):
        tree = subprocess.run(["xwininfo", "-display", display, "-root", "-tree"], check=True, capture_output=True, text=True).stdout
        self.window = int(re.search(rf'(0x[0-9a-f]+) "{re.escape(title)}', tree)[1], 16)
        self.x = ctypes.CDLL(ctypes.util.find_library("X11"))
        self.x.XOpenDisplay.restype = ctypes.c_void_p
        self.x.XInternAtom.restype = ctypes.c_ulong
        self.display = ctypes.c_void_p(self.x.XOpenDisplay(display.encode()))
        self.id = ctypes.c_ulong(self.window)

    def close(self):
        self.x.XCloseDisplay(self.display)

    def _sync(self):
        self.x.XSync(self.display, 0)

    def key(self, name):
        """Pressed, and let go."""
        self.x.XStringToKeysym.restype = ctypes.c_ulong
        self.x.XKeysymToKeycode.restype = ctypes.c_ubyte
        code = self.x.XKeysymToKeycode(self.display, ctypes.c_ulong(self.x.XStringToKeysym(name.encode())))
        for kind, mask in ((KEY_PRESS, KEY_PRESS_MASK), (KEY_RELEASE, KEY_RELEASE_MASK)):
            event = KeyEvent(type=kind, window=self.window, time=int(time.monotonic() * 1000) & 0xFFFFFFFF, keycode=code, same_screen=1)
            self.x.XSendEvent(self.display, self.id, 0, ctypes.c_long(mask), ctypes.byref(event))
            self._sync()

    def resize(self, width, height):
        self.x.XResizeWindow(self.display, self.id, width, height)
        self._sync()

    def cover_and_uncover(self):
        """What was there is gone, and the window is told."""
        self.x.XClearArea(self.display, self.id, 0, 0, 0, 0, 1)
        self._sync()

    def set_state(self, state):
        """As a window manager says that a window is minimised, or no longer."""
        atom = self.x.XInternAtom(self.display, b"WM_STATE", 0)
        data = (ctypes.c_long * 2)(state, 0)
        self.x.XChangeProperty(self.display, self.id, ctypes.c_ulong(atom), ctypes.c_ulong(atom), 32, 0, data, 2)
        self._sync()
