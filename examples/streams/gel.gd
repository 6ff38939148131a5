# Moves this node with the gel, in Godot 4. Start first: neurotouch stream websocket
extends Node3D

var socket := WebSocketPeer.new()


func _ready() -> void:
	socket.connect_to_url("ws://127.0.0.1:8765")


func _process(_delta: float) -> void:
	socket.poll()
	while socket.get_available_packet_count() > 0:
		var touch: Dictionary = JSON.parse_string(socket.get_packet().get_string_from_utf8())
		# A push moves, a twist turns, pinch and zoom scale.
		position = Vector3(touch.moved_mm[0], 0.0, touch.moved_mm[1]) * 0.1
		rotation = Vector3(0.0, -touch.turned_rad, 0.0)
		scale = Vector3.ONE * maxf(touch.scale, 0.1)
