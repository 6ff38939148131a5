// Tells neurotouch which application is in front, over the session bus. Titles are not read.

import Gio from 'gi://Gio';
import GLib from 'gi://GLib';
import {Extension} from 'resource:///org/gnome/shell/extensions/extension.js';

const PATH = '/io/github/neurotouch_hid/Windows';
const INTERFACE = `
<node>
  <interface name="io.github.neurotouch_hid.Windows">
    <method name="GetNames"><arg type="as" direction="out" name="names"/></method>
    <signal name="Activated"><arg type="as" name="names"/></signal>
  </interface>
</node>`;

export default class NeurotouchWindows extends Extension {
    enable() {
        this._object = Gio.DBusExportedObject.wrapJSObject(INTERFACE, this);
        this._object.export(Gio.DBus.session, PATH);
        this._handler = global.display.connect('notify::focus-window', () => {
            this._object.emit_signal('Activated', new GLib.Variant('(as)', [this.GetNames()]));
        });
    }

    disable() {
        global.display.disconnect(this._handler);
        this._object.unexport();
        this._object = null;
    }

    GetNames() {
        const window = global.display.focus_window;
        if (!window)
            return [];
        const names = [
            window.get_wm_class(),
            window.get_wm_class_instance(),
            window.get_gtk_application_id(),
        ];
        return names.filter(name => name);
    }
}
